// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_cloud.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "not_finite.h"
#include "refusal.h"

namespace palpate::geometry {
namespace {

/// A slope seen by a camera with a strong lens, with two unknown depths.
RangeMap small_map() {
  RangeMap map{.z = ImageF(6, 8),
               .camera = {.width = 8, .height = 6, .fx = 9, .fy = 10, .cx = 3.6, .cy = 2.4}};
  map.camera.distortion = {-0.08, 0.01, 1e-3, -2e-3, 0, 0, 0, 0};
  for (int i = 0; i < 48; ++i) map.z.data()[i] = 300.25F + 3.1F * static_cast<float>(i);
  map.z(2, 3) = kFloatNaN;
  map.z(5, 7) = kFloatNaN;
  return map;
}

TEST(OrganisedCloud, HasAPointPerPixelAndItsDeviation) {
  const RangeMap map = small_map();
  const ImageF sigma = 0.001F * map.z;
  const PointCloud cloud = organised_cloud(map, sigma);
  EXPECT_EQ(cloud.width, 8);
  EXPECT_EQ(cloud.height, 6);
  for (int v = 0; v < 6; ++v) {
    for (int u = 0; u < 8; ++u) {
      const Eigen::Vector3d point = cloud.points.col(v * 8 + u);
      if (std::isnan(map.z(v, u))) {
        EXPECT_TRUE(point.array().isNaN().all());
        continue;
      }
      EXPECT_EQ(point.z(), static_cast<double>(map.z(v, u)));
      EXPECT_LT((distort(map.camera, point.hnormalized()) - Eigen::Vector2d(u, v)).norm(), 1e-9);
      EXPECT_EQ((*scalars(cloud.attributes, "sigma"))[v * 8 + u], static_cast<double>(sigma(v, u)));
    }
  }
  EXPECT_TRUE(organised_cloud(map).attributes.empty());
}

TEST(RangeMapOf, IsTheRangeMapOfItsCloudToTheBit) {
  const RangeMap map = small_map();
  const RangeMap back = range_map_of(organised_cloud(map), map.camera);
  for (int i = 0; i < 48; ++i) {
    const float expected = map.z.data()[i], found = back.z.data()[i];
    EXPECT_TRUE(expected == found || (std::isnan(expected) && std::isnan(found))) << i;
  }
}

TEST(RangeMapOf, RefusesTheCloudOfAnotherCamera) {
  const RangeMap map = small_map();
  PointCloud cloud = organised_cloud(map);
  Camera other = map.camera;
  other.cx += 1;
  EXPECT_EQ(refusal([&] { return range_map_of(cloud, other); }),
            "the point of column 0, row 0 is not where this pixel of the camera sees "
            "it; is the cloud in the camera's frame, in mm, and not undistorted?");
  cloud.width = 48;
  cloud.height = 1;
  EXPECT_EQ(refusal([&] { return range_map_of(cloud, map.camera); }),
            "the cloud is 48 x 1 points, but the camera is 8 x 6 px; an organised "
            "cloud has a point per pixel");
  EXPECT_EQ(refusal([&] { return organised_cloud(map, ImageF::Zero(2, 3)); }),
            "organised_cloud: sigma is 3 x 2 px, but the range map is 8 x 6 px");
}

TEST(FittedCamera, IsThatOfTheRangeMap) {
  RangeMap map = small_map();
  map.camera.distortion = {};
  PointCloud cloud = organised_cloud(map);
  cloud.points.col(9).z() = -1;  // behind the camera
  const Camera camera = fitted_camera(cloud);
  EXPECT_EQ(camera.width, 8);
  EXPECT_EQ(camera.height, 6);
  EXPECT_NEAR(camera.fx, map.camera.fx, 1e-12);
  EXPECT_NEAR(camera.fy, map.camera.fy, 1e-12);
  EXPECT_NEAR(camera.cx, map.camera.cx, 1e-12);
  EXPECT_NEAR(camera.cy, map.camera.cy, 1e-12);
  cloud.points *= 1e-3;  // in another unit
  EXPECT_NEAR(fitted_camera(cloud).fx, map.camera.fx, 1e-12);
}

TEST(FittedCamera, RefusesWhatNoCameraSees) {
  RangeMap map = small_map();
  map.camera.distortion = {};
  const PointCloud cloud = organised_cloud(map);
  PointCloud other = cloud;
  other.points.row(1) *= -1;
  EXPECT_EQ(refusal([&] { return fitted_camera(other); }),
            "the cloud is mirrored: Y points to lower rows; X has to point right, Y "
            "down and Z away from the camera");
  other = cloud;
  other.points.rightCols(40).setConstant(kNaN);  // one row is left
  EXPECT_EQ(refusal([&] { return fitted_camera(other); }),
            "fewer than two columns or rows have points in front of the camera");
  other = cloud;
  other.width = 48;
  other.height = 1;
  EXPECT_EQ(refusal([&] { return fitted_camera(other); }),
            "the cloud is 48 x 1 points; an organised cloud has a point per pixel");
}

}  // namespace
}  // namespace palpate::geometry
