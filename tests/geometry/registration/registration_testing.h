// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "palpate/geometry/triangle_mesh.h"
#include "test_surfaces.h"

/// Points of known surfaces under known motions.
namespace palpate::geometry::test {

inline constexpr double kDegree = std::numbers::pi / 180;

/// [mm] The last step is below 1e-10 of a surface about 100 mm large.
inline constexpr double kFound = 1e-6;

/// 105 mm x 84 mm, without a symmetry.
inline TriangleMesh bumpy_surface() {
  return height_field(50, 40, 2.1, [](double x, double y) {
    return 8 * std::sin(x / 15.3) * std::cos(y / 12.1) + 4 * std::sin(x / 7.7 + y / 9.1) +
           0.002 * (x - 50) * (y - 40);
  });
}

/// Its triangles that begin within a range of x [mm].
inline TriangleMesh part_of_bumpy_surface(double from, double to) {
  TriangleMesh part = bumpy_surface();
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < part.triangles.cols(); ++t) {
    const double x = part.vertices(0, part.triangles(0, t));
    if (x >= from && x <= to) part.triangles.col(count++) = part.triangles.col(t).eval();
  }
  part.triangles.conservativeResize(3, count);
  return part;
}

inline Eigen::Matrix3Xd points_on(const TriangleMesh& mesh, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d weights{uniform(random), uniform(random), uniform(random)};
    points.col(i) =
        position(mesh, {.triangle = any(random), .barycentric = weights / weights.sum()});
  }
  return points;
}

/// A turn about the middle of the bumpy surface and a shift of up to 15 mm an axis.
inline Eigen::Isometry3d random_motion(double angle, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Vector3d axis{uniform(random), uniform(random), uniform(random)};
  const Eigen::Vector3d shift{uniform(random), uniform(random), uniform(random)};
  const Eigen::Vector3d middle(52, 42, 0);
  return Eigen::Translation3d(middle + 15 * shift) * Eigen::AngleAxisd(angle, axis.normalized()) *
         Eigen::Translation3d(-middle);
}

inline double largest_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

}  // namespace palpate::geometry::test
