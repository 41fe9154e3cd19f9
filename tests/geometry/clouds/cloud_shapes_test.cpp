// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_shapes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "cloud_testing.h"
#include "not_finite.h"
#include "palpate/geometry/cloud_normals.h"
#include "refusal.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using test::Matrix3Xd;
using test::Vector3d;

/// Least squares of exact points of some 10 mm.
constexpr double kFitRounding = 1e-9;
/// [mm] noise of the points below, and the part of it that remains in the mean of hundreds.
constexpr double kNoise = 0.05;
constexpr double kMeanNoise = 0.02;

/// 600 points on a plane, then 400 in the room around it.
struct PlaneInClutter {
  Vector3d point = {3, -2, 50};
  Vector3d normal = Vector3d(2, -1, 2) / 3;
  Matrix3Xd points;
  explicit PlaneInClutter(double noise) {
    const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
    const Matrix3Xd places =
        test::random_cloud(600, 1, {40, 30, 0}).colwise() - Vector3d(20, 15, 0);
    const Matrix3Xd plane = (u * places.row(0) + v * places.row(1)).colwise() + point;
    const Matrix3Xd clutter =
        test::random_cloud(400, 2, {40, 40, 40}).colwise() + (point - Vector3d(20, 20, 20));
    points = test::joined_points(test::with_noise(plane, noise, 3), clutter);
  }
};

TEST(FindPlane, IsExactForExactPointsAmongOthers) {
  const PlaneInClutter truth(0);
  const auto plane = find_plane(truth.points, {.tolerance = 1e-6});
  ASSERT_TRUE(plane);
  EXPECT_LT((plane->normal - truth.normal).norm(), kFitRounding);
  EXPECT_LT(std::abs(truth.normal.dot(plane->point - truth.point)), kFitRounding);
  EXPECT_EQ(plane->inliers.size(), 600U);
  EXPECT_EQ(plane->inliers.back(), 599);
  EXPECT_LT(plane->rms, kFitRounding);
}

TEST(FindPlane, IsThePlaneOfLeastSquaresOfItsInliers) {
  const PlaneInClutter truth(kNoise);
  const auto plane = find_plane(truth.points, {.tolerance = 3 * kNoise});
  ASSERT_TRUE(plane);
  const Matrix3Xd on_it = truth.points(Eigen::all, plane->inliers);
  const Matrix3Xd offsets = on_it.colwise() - on_it.rowwise().mean();
  const Eigen::JacobiSVD<Matrix3Xd> axes(offsets, Eigen::ComputeThinU);
  EXPECT_LT(plane->normal.cross(axes.matrixU().col(2)).norm(), kFitRounding);
  EXPECT_NEAR(plane->rms, axes.singularValues()[2] / std::sqrt(on_it.cols()), kFitRounding);
  EXPECT_LT(std::abs(truth.normal.dot(plane->point - truth.point)), kMeanNoise);
}

TEST(FindPlane, IsTheSameInAnotherFrameOrderAndScale) {
  const PlaneInClutter truth(kNoise);
  const auto plane = find_plane(truth.points, {.tolerance = 3 * kNoise});
  const Eigen::Isometry3d motion = test::some_motion();
  const auto moved = find_plane(motion * truth.points, {.tolerance = 3 * kNoise});
  const test::Shuffled other = test::shuffled(truth.points, 9);
  const auto mixed = find_plane(other.points, {.tolerance = 3 * kNoise});
  const auto large = find_plane(1e6 * truth.points, {.tolerance = 3e6 * kNoise});
  ASSERT_TRUE(plane && moved && mixed && large);
  EXPECT_LT((motion.linear() * plane->normal).cross(moved->normal).norm(), kFitRounding);
  EXPECT_EQ(moved->inliers, plane->inliers);
  EXPECT_EQ(test::in_first_order(other, mixed->inliers), plane->inliers);
  EXPECT_EQ(large->inliers, plane->inliers);
}

TEST(FindPlane, IsFoundFarFromTheOrigin) {
  const PlaneInClutter truth(kNoise);
  const auto far =
      find_plane(truth.points.colwise() + Vector3d(1e9, 1e9, -1e9), {.tolerance = 3 * kNoise});
  ASSERT_TRUE(far);
  EXPECT_LT(far->normal.cross(truth.normal).norm(), 1e-3);
}

TEST(FindPlane, NeedsItsShareOfThePoints) {
  const PlaneInClutter truth(kNoise);
  EXPECT_FALSE(find_plane(truth.points, {.tolerance = 3 * kNoise, .min_share = 0.7}));
  EXPECT_TRUE(find_plane(truth.points, {.tolerance = 3 * kNoise, .min_share = 0.5}));
}

TEST(FindSphere, IsExactForExactPointsAmongOthers) {
  const Vector3d centre(30, -20, 400);
  const Matrix3Xd points = test::joined_points(
      test::sphere_cloud(500, centre, 14),
      test::random_cloud(300, 4, {60, 60, 60}).colwise() + (centre - Vector3d(30, 30, 30)));
  const auto sphere = find_sphere(points, {.tolerance = 1e-6});
  ASSERT_TRUE(sphere);
  EXPECT_LT((sphere->centre - centre).norm(), kFitRounding);
  EXPECT_NEAR(sphere->radius, 14, kFitRounding);
  EXPECT_EQ(sphere->inliers.size(), 500U);
}

TEST(FindSphere, OfACapWithNoiseIsWhereLeastSquaresAreStationary) {
  Matrix3Xd cap = test::with_noise(test::sphere_cloud(2000, {0, 0, 0}, 25), kNoise, 5);
  cap = Matrix3Xd(cap.leftCols(500));  // the upper quarter of the height
  const auto sphere = find_sphere(cap, {.tolerance = 5 * kNoise, .min_share = 0.9});
  ASSERT_TRUE(sphere);
  EXPECT_NEAR(sphere->radius, 25, 0.1);
  // Means of the residuals, and of the residuals along each axis, vanish.
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  for (const int i : sphere->inliers) {
    const Vector3d offset = cap.col(i) - sphere->centre;
    const double residual = offset.norm() - sphere->radius;
    gradient.head<3>() += residual * offset.normalized();
    gradient[3] += residual;
  }
  EXPECT_LT(gradient.norm() / static_cast<double>(sphere->inliers.size()), kFitRounding);
}

TEST(FindSphere, IsNoPlaneUnlessItsRadiusMayBeLarge) {
  const Matrix3Xd flat = test::with_noise(test::random_cloud(500, 6, {40, 40, 0}), 0.01, 7);
  EXPECT_FALSE(find_sphere(flat, {.tolerance = 0.05, .min_share = 0.5}));
  const Matrix3Xd ball = test::sphere_cloud(500, {0, 0, 0}, 10);
  EXPECT_FALSE(find_sphere(ball, {.tolerance = 0.05, .min_share = 0.5, .max_radius = 9}));
}

TEST(FindCylinder, IsExactForExactPointsAndRoughNormals) {
  const Vector3d middle(3, 9, -40), axis = Vector3d(1, 4, 8) / 9;
  const Matrix3Xd points = test::joined_points(
      test::cylinder_cloud(1200, middle, axis, 7, 50, 8),
      test::random_cloud(500, 9, {60, 60, 60}).colwise() + (middle - Vector3d(30, 30, 30)));
  const Matrix3Xd normals = cloud_normals(points).normals;
  const auto cylinder = find_cylinder(points, normals, {.tolerance = 0.3});
  ASSERT_TRUE(cylinder);
  const auto exact =
      find_cylinder(points.leftCols(1200), normals.leftCols(1200), {.tolerance = 0.3});
  ASSERT_TRUE(exact);
  EXPECT_LT((exact->axis - axis).norm(), kFitRounding);
  EXPECT_NEAR(exact->radius, 7, kFitRounding);
  EXPECT_LT((exact->point - middle).cross(axis).norm(), kFitRounding);
  EXPECT_NEAR(exact->length, 50, 0.5);
  EXPECT_NEAR((exact->point - middle).dot(axis), 0, 0.5);
  // With some of the clutter near it.
  EXPECT_LT((cylinder->axis - axis).norm(), 0.01);
  EXPECT_NEAR(cylinder->radius, 7, 0.1);
  EXPECT_GE(cylinder->inliers.size(), 1190U);
}

TEST(FindCylinder, NeedsANormalPerPoint) {
  EXPECT_EQ(refusal([] {
              return find_cylinder(Matrix3Xd::Zero(3, 5), Matrix3Xd::Zero(3, 4), {.tolerance = 1});
            }),
            "find_cylinder: there are 4 normals for 5 points; cloud_normals gives one per point");
}

TEST(FindShapes, AreNoneInDegenerateClouds) {
  Matrix3Xd line(3, 60);
  for (int i = 0; i < 60; ++i) line.col(i) = i * Vector3d(1, -1, 2);
  const Matrix3Xd equal = Matrix3Xd::Constant(3, 60, 1e9);
  for (const Matrix3Xd& points : {Matrix3Xd(3, 0), Matrix3Xd(Matrix3Xd::Zero(3, 1)), equal, line,
                                  Matrix3Xd(Matrix3Xd::Constant(3, 60, kNaN))}) {
    const CloudShapeOptions options{.tolerance = 0.1, .min_share = 0.5};
    EXPECT_FALSE(find_plane(points, options));
    EXPECT_FALSE(find_sphere(points, options));
    EXPECT_FALSE(find_cylinder(points, cloud_normals(points).normals, options));
  }
}

TEST(FindShapes, AreTheSameWithOneThread) {
  const PlaneInClutter truth(kNoise);
  const auto plane = find_plane(truth.points, {.tolerance = 3 * kNoise});
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = find_plane(truth.points, {.tolerance = 3 * kNoise});
  ASSERT_TRUE(plane && alone);
  EXPECT_EQ(alone->normal, plane->normal);
  EXPECT_EQ(alone->point, plane->point);
}

TEST(FindShapes, TellTheirProgress) {
  // Of the cylinder none is found, and all trials are needed.
  const PlaneInClutter truth(kNoise);
  const Matrix3Xd normals = test::random_cloud(1000, 5, {1, 1, 1});
  check_progress(
      [&](const auto& progress) {
        (void)find_plane(truth.points, {.tolerance = 3 * kNoise, .progress = progress});
      },
      2);
  check_progress(
      [&](const auto& progress) {
        (void)find_cylinder(truth.points, normals, {.tolerance = 1e-9, .progress = progress});
      },
      4);
}

TEST(FindShapes, IgnoreUnknownPoints) {
  const PlaneInClutter truth(0);
  const Matrix3Xd points = test::joined_points(Matrix3Xd::Constant(3, 5, kNaN), truth.points);
  const auto plane = find_plane(points, {.tolerance = 1e-6});
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->inliers.front(), 5);
  EXPECT_EQ(plane->inliers.size(), 600U);
}

TEST(FindShapes, RefuseOptionsOutOfRange) {
  EXPECT_EQ(refusal([] { return find_plane(Matrix3Xd(3, 0), {}); }),
            "CloudShapeOptions::tolerance must be given");
  EXPECT_EQ(refusal([] { return find_plane(Matrix3Xd(3, 0), {.tolerance = 0}); }),
            "CloudShapeOptions::tolerance is 0 mm; it must be > 0 and finite");
  EXPECT_EQ(refusal([] { return find_plane(Matrix3Xd(3, 0), {.tolerance = 1, .max_radius = 5}); }),
            "CloudShapeOptions::max_radius does nothing: a plane has no radius");
  EXPECT_EQ(refusal([] { return find_sphere(Matrix3Xd(3, 0), {.tolerance = 1, .min_share = 0}); }),
            "CloudShapeOptions::min_share is 0; it must be in (0, 1]");
  EXPECT_EQ(
      refusal([] { return find_sphere(Matrix3Xd(3, 0), {.tolerance = 1, .max_radius = -2}); }),
      "CloudShapeOptions::max_radius is -2 mm; it must be > 0");
}

}  // namespace
}  // namespace palpate::geometry
