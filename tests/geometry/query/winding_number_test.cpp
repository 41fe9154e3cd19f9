// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/winding_number.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

Eigen::Matrix3Xd points_in_cube(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&](auto, auto) { return uniform(random); });
}

/// The angles of the spherical triangles (Girard's theorem), which is not how the library computes
/// them.
double sum_of_all_angles(const TriangleMesh& mesh, const Vector3d& point) {
  double sum = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    const Vector3d a = (mesh.vertices.col(t[0]) - point).normalized();
    const Vector3d b = (mesh.vertices.col(t[1]) - point).normalized();
    const Vector3d c = (mesh.vertices.col(t[2]) - point).normalized();
    const auto angle = [](const Vector3d& at, const Vector3d& p, const Vector3d& q) {
      const Vector3d u = at.cross(p), v = at.cross(q);
      return std::atan2(u.cross(v).norm(), u.dot(v));
    };
    const double excess = angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - pi;
    sum += a.dot(b.cross(c)) > 0 ? excess : -excess;
  }
  return sum / (4 * pi);
}

/// Winding number, at height z on the axis, of a cap over a regular polygon of `corners` corners on
/// a circle of radius `radius` about the origin, at points below the cap: that of the part not
/// hidden by the polygon, the base of a regular pyramid of known angle.
double below_a_cap(double radius, int corners, double z) {
  const double pyramid =
      2 * pi -
      2 * corners * std::atan(std::tan(pi / corners) / std::sqrt(1 + std::pow(radius / z, 2)));
  return z > 0 ? 1 - pyramid / (4 * pi) : pyramid / (4 * pi);
}

/// Half a sphere over the plane z = 0, outwards, with its pole.
TriangleMesh hemisphere(double radius, int around, int up) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, around * up + 1);
  mesh.triangles.resize(3, around * (2 * up - 1));
  int t = 0;
  for (int r = 0; r < up; ++r) {
    for (int i = 0; i < around; ++i) {
      const double height = pi / 2 * r / up, angle = 2 * pi * i / around;
      mesh.vertices.col(r * around + i) << radius * std::cos(height) * std::cos(angle),
          radius * std::cos(height) * std::sin(angle), radius * std::sin(height);
      const int a = r * around + i, b = r * around + (i + 1) % around;
      if (r + 1 == up) {
        mesh.triangles.col(t++) << a, b, around * up;
      } else {
        mesh.triangles.col(t++) << a, b, b + around;
        mesh.triangles.col(t++) << a, b + around, a + around;
      }
    }
  }
  mesh.vertices.rightCols(1) << 0, 0, radius;
  return mesh;
}

TEST(WindingNumber, IsTheSumOfAllSolidAnglesWithinTheTolerance) {
  for (const TriangleMesh& mesh :
       {test::random_triangles(400, 30, 1), test::bumpy(3000, 0.25), test::glove(6.3)}) {
    const WindingNumber winding(mesh);
    const Vector3d middle = mesh.vertices.rowwise().mean();
    const double size = bounding_diagonal(mesh);
    double largest = 0;
    for (const double reach : {0.3, 0.7, 5.0}) {
      const Eigen::Matrix3Xd points = points_in_cube(15, reach * size, 2).colwise() + middle;
      for (const auto& p : points.colwise()) {
        const double expected = sum_of_all_angles(mesh, p);
        EXPECT_NEAR(winding.at(p, 0), expected, 1e-10);
        for (const double tolerance : {0.1, 0.01, 1e-4}) {
          const double error = std::abs(winding.at(p, tolerance) - expected);
          EXPECT_LE(error, tolerance);
          largest = std::max(largest, error / tolerance);
        }
        if (std::abs(expected - 0.5) > 1e-9) {
          EXPECT_EQ(winding.contains(p), expected > 0.5);
        }
      }
    }
    EXPECT_GT(largest, 1e-3);  // clusters are used indeed
  }
}

TEST(WindingNumber, IsOneInsideAClosedSphereAndZeroOutside) {
  const double radius = 10.7;
  const TriangleMesh sphere = test::icosphere(3, radius);
  const WindingNumber winding(sphere);
  const Eigen::Matrix3Xd points = points_in_cube(200, 1.5 * radius, 3);
  const Eigen::VectorXd exact = winding_numbers(winding, points, 0);
  const Eigen::VectorXd near = winding_numbers(winding, points);
  const Eigen::VectorX<bool> inside = contained(winding, points);
  int within = 0;
  for (int i = 0; i < 200; ++i) {
    const double distance = points.col(i).norm() / radius;
    if (distance > 0.985 && distance < 1) continue;  // flat triangles are inside of the sphere
    EXPECT_NEAR(exact[i], distance < 1 ? 1 : 0, 1e-11);
    EXPECT_NEAR(near[i], distance < 1 ? 1 : 0, 0.01);
    EXPECT_EQ(inside[i], distance < 1);
    within += distance < 1;
  }
  EXPECT_GT(within, 20);
}

TEST(WindingNumber, OfAHemisphereFollowsTheSolidAngleOfItsRim) {
  constexpr int kAround = 48;
  const double radius = 20;
  const WindingNumber winding(hemisphere(radius, kAround, 12));
  for (const double z : {-60.0, -20.0, -1.7, -1e-3, 1e-3, 0.9, 7.0, 19.0}) {
    EXPECT_NEAR(winding.at({0, 0, z}, 0), below_a_cap(radius, kAround, z), 1e-12) << z;
    EXPECT_NEAR(winding.at({0, 0, z}, 1e-3), below_a_cap(radius, kAround, z), 1e-3) << z;
    EXPECT_EQ(winding.contains({0, 0, z}), z > 0) << z;
    // For a round rim: 1/2 + z / (2 sqrt(z^2 + r^2)).
    EXPECT_NEAR(winding.at({0, 0, z}, 0), 0.5 + z / std::hypot(z, radius) / 2, 3e-3) << z;
  }
  EXPECT_NEAR(winding.at({0, 0, 30}, 0), below_a_cap(radius, kAround, 30) - 1, 1e-12);
}

TEST(WindingNumber, DoesNotDependOnPlaceDirectionAndUnit) {
  const TriangleMesh mesh = test::bumpy(3000, 0.25);
  const Vector3d middle = mesh.vertices.rowwise().mean();
  const Eigen::Matrix3Xd points =
      points_in_cube(40, 0.5 * bounding_diagonal(mesh), 4).colwise() + middle;
  const Eigen::VectorXd expected = winding_numbers(WindingNumber(mesh), points, 0);
  Eigen::Isometry3d T(Eigen::AngleAxisd(1.1, Vector3d(1, 2, -2) / 3));
  T.pretranslate(Vector3d(300, -200, 1000));
  const WindingNumber moved(test::moved(mesh, T));
  const WindingNumber scaled(test::scaled(mesh, 0x1p-20));
  for (int i = 0; i < 40; ++i) {
    EXPECT_NEAR(moved.at(T * Vector3d(points.col(i)), 0), expected[i], 1e-9);
    EXPECT_EQ(scaled.at(0x1p-20 * points.col(i), 0), expected[i]);
  }
}

TEST(WindingNumber, AddsUpWhereSurfacesOverlapAndSubtractsCavities) {
  const TriangleMesh outer = test::icosphere(2, 10), inner = test::icosphere(2, 5);
  TriangleMesh both;
  both.vertices.resize(3, outer.vertices.cols() + inner.vertices.cols());
  both.vertices << outer.vertices, inner.vertices;
  both.triangles.resize(3, outer.triangles.cols() + inner.triangles.cols());
  both.triangles << outer.triangles,
      inner.triangles.array() + static_cast<int>(outer.vertices.cols());
  EXPECT_NEAR(WindingNumber(both).at({1, 2, 0}, 0), 2, 1e-12);
  EXPECT_NEAR(WindingNumber(both).at({1, 7, 0}, 0), 1, 1e-12);
  both.triangles.rightCols(inner.triangles.cols())
      .row(0)
      .swap(both.triangles.rightCols(inner.triangles.cols()).row(1));
  EXPECT_NEAR(WindingNumber(both).at({1, 2, 0}, 0), 0, 1e-12);
  EXPECT_FALSE(WindingNumber(both).contains({1, 2, 0}));
  EXPECT_TRUE(WindingNumber(both).contains({1, 7, 0}));
}

TEST(WindingNumber, IsNoNumberWhereThereIsNoPointAndZeroFarAway) {
  const WindingNumber winding(test::icosphere(1, 10));
  EXPECT_TRUE(std::isnan(winding.at({0, kNaN, 0})));
  EXPECT_TRUE(std::isnan(winding.at({kInf, 0, 0})));
  EXPECT_FALSE(winding.contains({0, kNaN, 0}));
  EXPECT_FALSE(winding.contains({kInf, 0, 0}));
  for (const double far : {1e6, 1e60, 1e300}) EXPECT_NEAR(winding.at({far, -far, 0}, 0), 0, 1e-12);
  EXPECT_THROW((void)winding.at({0, 0, 0}, -0.1), InvalidInput);
  EXPECT_THROW((void)winding.at({0, 0, 0}, kNaN), InvalidInput);
  EXPECT_THROW((void)winding_numbers(winding, Eigen::Matrix3Xd(3, 0), -1), InvalidInput);
  EXPECT_THROW(WindingNumber(TriangleMesh{}), InvalidInput);
}

TEST(WindingNumber, IsFoundOnFlatAndCollapsedTriangles) {
  TriangleMesh sphere = test::icosphere(2, 10);
  // Two vertices coincide: two triangles without area, the others close the surface.
  sphere.vertices.col(sphere.triangles(1, 0)) = sphere.vertices.col(sphere.triangles(0, 0));
  const WindingNumber winding(sphere);
  EXPECT_NEAR(winding.at({1, 2, 3}, 0), 1, 1e-12);
  EXPECT_NEAR(winding.at({1, 2, 30}, 0), 0, 1e-12);
  TriangleMesh point{.vertices = Eigen::Matrix3Xd::Ones(3, 3),
                     .triangles = Eigen::Vector3i(0, 1, 2)};
  EXPECT_EQ(WindingNumber(point).at({1, 2, 3}, 0), 0);
}

}  // namespace
}  // namespace palpate::geometry
