// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/depth_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

geometry::Camera camera_of(int width, int height) {
  return {.width = width, .height = height, .fx = 476, .fy = 476, .cx = 313, .cy = 242};
}

TEST(DepthImage, ScalesUnitsAndKeepsUnknownApart) {
  const ScratchFolder folder;
  cv::Mat image = (cv::Mat_<ushort>(2, 3) << 0, 1, 2, 3, 65535, 8);
  cv::imwrite((folder / "d.png").string(), image);
  const geometry::RangeMap map = read_depth_image(folder / "d.png", 0.125, camera_of(3, 2));
  EXPECT_TRUE(std::isnan(map.z(0, 0)));
  EXPECT_EQ(map.z(0, 1), 0.125F);
  EXPECT_EQ(map.z(1, 1), 65535 * 0.125F);
  EXPECT_EQ(map.z(1, 2), 1.0F);
  EXPECT_EQ(map.camera.fx, 476);
}

TEST(DepthImage, ReadsTheBundledHand) {
  const geometry::RangeMap map =
      read_depth_image(demo_path("depth_camera/hand.png"), 0.125, camera_of(640, 480));
  const auto known = (map.z > 0).count();
  EXPECT_GT(known, 1000);
  EXPECT_EQ(known + map.z.isNaN().count(), map.z.size());
}

TEST(DepthImage, RefusesWrongTypeSizeAndScale) {
  const ScratchFolder folder;
  cv::imwrite((folder / "d16.png").string(), cv::Mat(2, 3, CV_16UC1, cv::Scalar(7)));
  cv::imwrite((folder / "d8.png").string(), cv::Mat(2, 3, CV_8UC1, cv::Scalar(7)));
  cv::imwrite((folder / "color.png").string(), cv::Mat(2, 3, CV_16UC3, cv::Scalar(7, 7, 7)));
  EXPECT_THROW((void)read_depth_image(folder / "d8.png", 1, camera_of(3, 2)), FileError);
  EXPECT_THROW((void)read_depth_image(folder / "color.png", 1, camera_of(3, 2)), FileError);
  EXPECT_THROW((void)read_depth_image(folder / "d16.png", 1, camera_of(2, 3)), FileError);
  EXPECT_THROW((void)read_depth_image(folder / "none.png", 1, camera_of(3, 2)), FileError);
  for (const double scale : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)read_depth_image(folder / "d16.png", scale, camera_of(3, 2)), InvalidInput);
  }
  EXPECT_THROW((void)read_depth_image(folder / "d16.png", 1, geometry::Camera{}), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
