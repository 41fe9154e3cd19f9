// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/registration.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>

#include "palpate/error.h"
#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180;

/// Steps are estimated from points in float, 6e-8 of the surface's size of about 100 mm.
constexpr double kFound = 1e-5;

TriangleMesh bumpy_surface() {
  return test::height_field(50, 40, 2.1, [](double x, double y) {
    return 8 * std::sin(x / 15.3) * std::cos(y / 12.1) + 4 * std::sin(x / 7.7 + y / 9.1) +
           0.002 * (x - 50) * (y - 40);
  });
}

Matrix3Xd points_on(const TriangleMesh& mesh, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) {
    const Vector3d weights(uniform(random), uniform(random), uniform(random));
    points.col(i) =
        position(mesh, {.triangle = any(random), .barycentric = weights / weights.sum()});
  }
  return points;
}

/// A turn about the middle of the surface and a shift of up to 15 mm an axis.
Isometry3d random_motion(double angle, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vector3d axis(uniform(random), uniform(random), uniform(random));
  const Vector3d shift(uniform(random), uniform(random), uniform(random));
  const Vector3d middle(52, 42, 0);
  return Eigen::Translation3d(middle + 15 * shift) * Eigen::AngleAxisd(angle, axis.normalized()) *
         Eigen::Translation3d(-middle);
}

double largest_distance(const Matrix3Xd& a, const Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

TEST(RegisterPoints, FindsARigidMotionAgain) {
  const TriangleMesh target = bumpy_surface();
  unsigned seed = 0;
  for (const double angle : {0.0, 10 * kDegree, 18 * kDegree, 25 * kDegree}) {
    for (int trial = 0; trial < 4; ++trial) {
      const Matrix3Xd truth = points_on(target, 400, ++seed);
      const Matrix3Xd moved = random_motion(angle, seed) * truth;
      const Registration found = register_points(moved, target);
      EXPECT_EQ(found.stop, RegistrationStop::converged);
      EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFound) << seed;
      EXPECT_LT(found.rms, kFound);
      EXPECT_EQ(found.pairs, 400);
    }
  }
}

TEST(RegisterPoints, OfFewContactsFindsTheMotionToo) {
  const TriangleMesh target = bumpy_surface();
  const Matrix3Xd truth = points_on(target, 40, 3);
  const Matrix3Xd moved = random_motion(10 * kDegree, 4) * truth;
  EXPECT_LT(largest_distance(register_points(moved, target).T_target_source * moved, truth),
            kFound);
}

TEST(RegisterPoints, OfSourceAndTargetSwappedIsTheInverse) {
  const TriangleMesh a = bumpy_surface();
  const TriangleMesh b = test::moved(a, random_motion(12 * kDegree, 7));
  const Isometry3d T_b_a = register_points(a.vertices, b).T_target_source;
  const Isometry3d T_a_b = register_points(b.vertices, a).T_target_source;
  EXPECT_LT(largest_distance(T_b_a * a.vertices, b.vertices), kFound);
  EXPECT_LT(largest_distance(T_a_b * (T_b_a * a.vertices), a.vertices), kFound);
}

TEST(RegisterPoints, AveragesNoise) {
  const TriangleMesh target = bumpy_surface();
  constexpr int kCount = 3000;
  constexpr double kNoise = 0.05;
  const Matrix3Xd truth = points_on(target, kCount, 8);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, kNoise);
  const Matrix3Xd noisy = truth.unaryExpr([&](double x) { return x + normal(random); });
  const Matrix3Xd moved = random_motion(10 * kDegree, 10) * noisy;
  const Registration found = register_points(moved, target);
  // Only the part of the noise along the normal is a distance.
  EXPECT_NEAR(found.rms, kNoise, 0.1 * kNoise);
  EXPECT_LT(largest_distance(found.T_target_source * moved, noisy), 0.5 * kNoise);
}

TEST(RegisterPoints, MeasuresTheDistanceToTheTriangles) {
  // Half of the points 0.3 mm above, half below the middle of a plate whose vertices are far away.
  const TriangleMesh plate = test::flat_sheet(4, 4, 25);
  Matrix3Xd points(3, 200);
  for (int i = 0; i < 200; ++i) {
    points.col(i) << 7.3 + 4.1 * (i / 2 % 20), 9.1 + 15.7 * (i / 40), i % 2 == 0 ? 0.3 : -0.3;
  }
  const Registration found = register_points(points, plate);
  EXPECT_NEAR(found.rms, 0.3, kFound);
  EXPECT_LT(largest_distance(found.T_target_source * points, points), kFound);
}

TEST(RegisterPoints, DoesNotSlideOnAPlateOrASphere) {
  const TriangleMesh plate = test::flat_sheet(10, 10, 10.3);
  const Matrix3Xd truth = points_on(plate, 100, 11);
  const Isometry3d tilt =
      Eigen::Translation3d(0, 0, 4.2) * Eigen::AngleAxisd(0.05, Vector3d(0.6, 0.8, 0));
  const Registration on_plate = register_points(tilt * truth, plate);
  EXPECT_EQ(on_plate.stop, RegistrationStop::converged);
  EXPECT_LT(on_plate.rms, kFound);
  EXPECT_LT(largest_distance(on_plate.T_target_source * (tilt * truth), truth), 2);

  const TriangleMesh sphere = test::icosphere(4, 50);
  const Matrix3Xd shifted = sphere.vertices.colwise() + Vector3d(2, -1, 3);
  const Registration on_sphere = register_points(shifted, sphere);
  EXPECT_LT(largest_distance(on_sphere.T_target_source * shifted, sphere.vertices), 0.5);
}

TEST(RegisterPoints, LeavesOutPointsThatAreNotFinite) {
  const TriangleMesh target = bumpy_surface();
  const Matrix3Xd moved = random_motion(10 * kDegree, 12) * points_on(target, 100, 13);
  Matrix3Xd with_gaps(3, 103);
  with_gaps << Vector3d(kNan, 1, 2), moved.leftCols(50),
      Vector3d(1, std::numeric_limits<double>::infinity(), 2), moved.rightCols(50),
      Vector3d(kNan, kNan, kNan);
  const Registration expected = register_points(moved, target);
  const Registration found = register_points(with_gaps, target);
  EXPECT_EQ(found.T_target_source.matrix(), expected.T_target_source.matrix());
  EXPECT_EQ(found.pairs, expected.pairs);
}

TEST(RegisterPoints, ScalesExactlyWithTheUnitOfLength) {
  const TriangleMesh target = bumpy_surface();
  const Matrix3Xd moved = random_motion(10 * kDegree, 14) * points_on(target, 100, 15);
  const Registration expected = register_points(moved, target);
  for (const double factor : {0x1p-20, 0x1p20}) {
    const Registration scaled = register_points(factor * moved, test::scaled(target, factor));
    EXPECT_EQ(scaled.T_target_source.linear(), expected.T_target_source.linear());
    EXPECT_EQ(scaled.T_target_source.translation(),
              factor * expected.T_target_source.translation());
    EXPECT_EQ(scaled.rms, factor * expected.rms);
  }
}

TEST(RegisterPoints, WorksOneKilometreAway) {
  const Isometry3d far(Eigen::Translation3d(1e6, -0.7e6, 0.3e6));
  const TriangleMesh target = test::moved(bumpy_surface(), far);
  const Matrix3Xd truth = points_on(target, 200, 16);
  const Isometry3d motion = far * random_motion(15 * kDegree, 17) * far.inverse();
  const Matrix3Xd moved = motion * truth;
  EXPECT_LT(largest_distance(register_points(moved, target).T_target_source * moved, truth),
            kFound);
}

TEST(RegisterPoints, SaysWhenItStoppedForAnotherReason) {
  const TriangleMesh target = bumpy_surface();
  const Matrix3Xd truth = points_on(target, 100, 18);
  const Matrix3Xd moved = random_motion(10 * kDegree, 19) * truth;
  EXPECT_EQ(register_points(moved, target, {.max_iterations = 2}).stop,
            RegistrationStop::max_iterations);
  const Registration lost = register_points(truth.colwise() + Vector3d(0, 0, 500), target);
  EXPECT_EQ(lost.stop, RegistrationStop::too_few_pairs);
  EXPECT_EQ(lost.pairs, 0);
  EXPECT_TRUE(std::isnan(lost.rms));
  EXPECT_EQ(lost.T_target_source.matrix(), Eigen::Matrix4d::Identity());
}

std::string refusal(const Matrix3Xd& points, const TriangleMesh& target,
                    const RegistrationOptions& options = {}) {
  try {
    (void)register_points(points, target, options);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RegisterPoints, RefusesBadInputAndNamesIt) {
  const TriangleMesh target = bumpy_surface();
  Matrix3Xd points = points_on(target, 4, 20);
  EXPECT_EQ(refusal(points, target), "accepted");
  EXPECT_NE(refusal(points, {}).find("the target"), std::string::npos);
  EXPECT_NE(refusal(points, target, {.max_iterations = 0}).find("max_iterations"),
            std::string::npos);
  for (const double bad : {0.0, -1.0, kNan}) {
    EXPECT_NE(refusal(points, target, {.max_correspondence = bad}).find("max_correspondence"),
              std::string::npos);
  }
  points.rightCols(2).setConstant(kNan);
  EXPECT_NE(refusal(points, target).find("2 of the 4 points are finite"), std::string::npos);
  TriangleMesh no_area = test::flat_sheet(1, 1, 1);
  no_area.vertices.setZero();
  EXPECT_EQ(register_points(points_on(target, 4, 20), no_area).stop,
            RegistrationStop::too_few_pairs);
}

}  // namespace
}  // namespace palpate::geometry
