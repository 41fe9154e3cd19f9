// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_normals.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>

#include "cloud_testing.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "refusal.h"
#include "test_surfaces.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using test::Matrix3Xd;
using test::Vector3d;

constexpr double kNormalRounding = 1e-12;

/// Largest angle [rad] between normals and those that are right, side included.
double largest_angle(const Matrix3Xd& normals, const Matrix3Xd& right) {
  double largest = 0;
  for (Eigen::Index i = 0; i < normals.cols(); ++i) {
    const Vector3d a = normals.col(i), b = right.col(i);
    largest = std::max(largest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return largest;
}

TEST(CloudNormals, OfASpherePointOutwards) {
  const Vector3d centre(5, -3, 800);
  const Matrix3Xd points = test::sphere_cloud(3000, centre, 12);
  const CloudNormals found = cloud_normals(points);
  EXPECT_EQ(found.unknown, 0);
  // The neighbours of a point lie around it in a circle of some 2 mm, but not quite evenly.
  constexpr double kUneven = 0.02;
  EXPECT_LT(largest_angle(found.normals, (points.colwise() - centre).colwise().normalized()),
            kUneven);
}

TEST(CloudNormals, OfPlanesAreExact) {
  const Vector3d normal = Vector3d(1, 2, -2) / 3;
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  const Matrix3Xd places = test::random_cloud(500, 1, {30, 30, 0});
  const Matrix3Xd points = u * places.row(0) + v * places.row(1);
  const CloudNormals found = cloud_normals(points, {.viewpoints = 100 * normal});
  EXPECT_LT(largest_angle(found.normals, normal.replicate(1, points.cols())), kNormalRounding);
}

TEST(CloudNormals, OfAClosedScanAgreeWithItsMesh) {
  // A torus is neither convex nor simply connected: only neighbours determine the side.
  const TriangleMesh mesh = test::torus(96, 48, 20, 8);
  const CloudNormals found = cloud_normals(mesh.vertices);
  EXPECT_LT(largest_angle(found.normals, vertex_normals(mesh)), 0.1);
}

TEST(CloudNormals, PointToTheirOwnViewpoints) {
  const Matrix3Xd points = test::sphere_cloud(500, {0, 0, 0}, 10);
  Matrix3Xd views(3, 500);
  for (int i = 0; i < 500; ++i) views.col(i) = (i % 2 == 0 ? 2.0 : 0.5) * points.col(i);
  const Matrix3Xd normals = cloud_normals(points, {.viewpoints = views}).normals;
  for (int i = 0; i < 500; ++i) EXPECT_EQ(normals.col(i).dot(points.col(i)) > 0, i % 2 == 0);
}

TEST(CloudNormals, OfSeveralPartsEachPointOutwards) {
  const Matrix3Xd one = test::sphere_cloud(800, {0, 0, 0}, 5);
  const Matrix3Xd two = test::sphere_cloud(900, {30, 0, 0}, 7);
  const Matrix3Xd normals = cloud_normals(test::joined_points(one, two)).normals;
  for (Eigen::Index i = 0; i < 1700; ++i) {
    const Vector3d outwards =
        i < 800 ? Vector3d(one.col(i)) : Vector3d(two.col(i - 800) - Vector3d(30, 0, 0));
    EXPECT_GT(normals.col(i).dot(outwards), 0);
  }
}

TEST(CloudNormals, TurnWithTheFrameAndDoNotDependOnOrderOrScale) {
  const Matrix3Xd points = test::with_noise(test::sphere_cloud(1500, {0, 0, 0}, 10), 0.02, 5);
  const Matrix3Xd normals = cloud_normals(points).normals;
  const Eigen::Isometry3d motion = test::some_motion();
  EXPECT_LT(largest_angle(cloud_normals(motion * points).normals, motion.linear() * normals), 1e-9);
  EXPECT_LT(largest_angle(cloud_normals(1e-4 * points).normals, normals), 1e-9);
  const test::Shuffled other = test::shuffled(points, 6);
  EXPECT_LT(largest_angle(cloud_normals(other.points).normals, normals(Eigen::all, other.order)),
            kNormalRounding);
}

TEST(CloudNormals, AreTheSameWithOneThread) {
  const Matrix3Xd points = test::random_cloud(3000, 7, {10, 10, 1});
  const Matrix3Xd normals = cloud_normals(points).normals;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(cloud_normals(points).normals, normals);
}

TEST(CloudNormals, AreUnknownOnALineOrInOnePlace) {
  Matrix3Xd line(3, 40);
  for (int i = 0; i < 40; ++i) line.col(i) = i * Vector3d(1, 2, 3);
  EXPECT_EQ(cloud_normals(line).unknown, 40);
  EXPECT_EQ(cloud_normals(Matrix3Xd::Constant(3, 40, 1e9)).unknown, 40);
  EXPECT_EQ(cloud_normals(Matrix3Xd::Zero(3, 1)).unknown, 1);
  EXPECT_EQ(cloud_normals(Matrix3Xd(3, 0)).normals.cols(), 0);
}

TEST(CloudNormals, IgnoreUnknownPoints) {
  Matrix3Xd points = test::sphere_cloud(600, {0, 0, 0}, 10);
  const Matrix3Xd alone = cloud_normals(points).normals;
  Matrix3Xd more = test::joined_points(points, Matrix3Xd::Constant(3, 50, kNaN));
  const CloudNormals found = cloud_normals(more);
  EXPECT_EQ(found.unknown, 50);
  EXPECT_EQ(found.normals.leftCols(600), alone);
}

TEST(CloudNormals, TellTheirProgress) {
  const Matrix3Xd points = test::sphere_cloud(60000, {0, 0, 0}, 10);
  for (const Matrix3Xd& viewpoints : {Matrix3Xd(3, 0), Matrix3Xd(Matrix3Xd::Zero(3, 1))}) {
    check_progress(
        [&](const auto& progress) {
          (void)cloud_normals(points,
                              {.neighbours = 3, .viewpoints = viewpoints, .progress = progress});
        },
        3);
  }
}

TEST(CloudNormals, RefuseWrongOptions) {
  const Matrix3Xd points = Matrix3Xd::Identity(3, 3);
  EXPECT_EQ(refusal([&] { return cloud_normals(points, {.neighbours = 2}); }),
            "CloudNormalOptions::neighbours is 2; it must be in [3, 1000]");
  EXPECT_EQ(refusal([&] { return cloud_normals(points, {.viewpoints = Matrix3Xd::Zero(3, 2)}); }),
            "CloudNormalOptions::viewpoints: there are 2 for 3 points; none, one, or one per point "
            "are expected");
  EXPECT_EQ(refusal([&] {
              return cloud_normals(points, {.viewpoints = Matrix3Xd::Constant(3, 1, kInf)});
            }),
            "CloudNormalOptions::viewpoints: not all are finite");
}

}  // namespace
}  // namespace palpate::geometry
