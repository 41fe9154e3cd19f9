// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/registration_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "mesh_corpus.h"
#include "registration/registration_testing.h"

namespace palpate::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// [local frame] distances are about 0.01, and equally near triangles may be exchanged.
constexpr double kExchangeRounding = 1e-15;

TEST(RegistrationTarget, PairsPointsOnTheirWayAsAtFirstSight) {
  const TriangleMesh surface = test::bumpy(20000, 0.25);
  const RegistrationTarget::Impl target(surface, TargetUse::once);
  const Matrix3Xd points =
      target.scale * (test::points_on(surface, 1000, 3).colwise() - target.centre);
  Isometry3d pose(Eigen::AngleAxisd(0.02, Vector3d(1, 2, -1).normalized()));
  TrackedPairing tracked;
  const WorkSteps::Progress nobody;
  WorkSteps steps(nobody, 1);
  for (double angle = 0.02; angle > 1e-8; angle /= 4) {
    const double slack = 2 * angle;
    Matrix3Xd moved = pose * points;
    target.pair(moved, slack, tracked, steps);
    const Matrix3Xd places = moved;
    // Ways in all directions, also away from the surface.
    pose = Eigen::AngleAxisd(angle, Vector3d(-3, std::sin(1 / angle), 2).normalized()) *
           Eigen::Translation3d(0, angle / 3, -angle / 4) * pose;
    moved = pose * points;
    target.pair(moved, slack, tracked, steps);
    const Pairing fresh = target.pair(moved);
    int kept = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      EXPECT_NEAR(tracked.pairing.distances[i], fresh.distances[i], kExchangeRounding);
      if (tracked.triangles[static_cast<size_t>(i)].searched_at != moved.col(i)) ++kept;
    }
    // The triangles are 0.006 wide.
    if (angle < 1e-4) {
      EXPECT_GT(kept, points.cols() / 2);
    }
  }
}

/// Distance of a point from the sides that only one triangle has.
class Border {
 public:
  explicit Border(const TriangleMesh& mesh) {
    std::map<std::pair<int, int>, int> uses;
    for (const auto& t : mesh.triangles.colwise()) {
      for (int k = 0; k < 3; ++k) ++uses[std::minmax({t[k], t[(k + 1) % 3]})];
    }
    for (const auto& [side, count] : uses) {
      if (count == 1)
        sides_.push_back({mesh.vertices.col(side.first), mesh.vertices.col(side.second)});
    }
  }
  [[nodiscard]] double distance(const Vector3d& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : sides_) {
      const double s = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      least = std::min(least, (point - a - s * (b - a)).norm());
    }
    return least;
  }

 private:
  std::vector<std::array<Vector3d, 2>> sides_;
};

TEST(RegistrationTarget, LeavesOutPointsBesideTheSurfaceWhicheverWayItsTrianglesTurn) {
  TriangleMesh surface = test::part_of_bumpy_surface(20, 70);
  // Holes, triangles turned over, and a flap on a side of two others.
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    if (t % 97 == 5) continue;
    const Eigen::Vector3i triangle = surface.triangles.col(t);
    surface.triangles.col(count++) = t % 13 == 1 ? Eigen::Vector3i(triangle.reverse()) : triangle;
  }
  surface.triangles.conservativeResize(3, count + 1);
  const Eigen::Index top = surface.vertices.cols();
  surface.vertices.conservativeResize(3, top + 1);
  surface.vertices.col(top) =
      surface.vertices.col(surface.triangles(0, count / 2)) + Vector3d(0, 0, 9);
  surface.triangles.col(count) << surface.triangles(0, count / 2), surface.triangles(1, count / 2),
      static_cast<int>(top);
  const RegistrationTarget::Impl target(surface, TargetUse::once);
  const Border border(surface);
  const SurfaceTree tree(surface);
  // Its vertices, points on it, and points around it.
  Matrix3Xd points(3, top + 3000);
  points.leftCols(top) = surface.vertices.leftCols(top);
  points.middleCols(top, 1500) = test::points_on(surface, 1500, 4);
  points.rightCols(1500) = (test::points_on(surface, 1500, 5) + 8 * Matrix3Xd::Random(3, 1500));
  const Pairing pairing = target.pair(target.scale * (points.colwise() - target.centre));
  int beside = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const NearestTriangle nearest =
        tree.nearest(tree.to_local(points.col(i)), std::numeric_limits<double>::infinity());
    const bool expected =
        border.distance(tree.position(nearest.place, nearest.at.barycentric)) < 1e-12;
    EXPECT_EQ(!pairing.usable[i], expected) << i;
    if (expected) ++beside;
  }
  EXPECT_GT(beside, 300);
  EXPECT_LT(beside, points.cols() / 2);
}

}  // namespace
}  // namespace palpate::geometry
