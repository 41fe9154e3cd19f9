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

TEST(DepthImage, IsWrittenWithinHalfAUnitOfEachDepth) {
  const ScratchFolder folder;
  constexpr double kUnit = 0.1;
  geometry::ImageF z(3, 4);
  z << 0.05F, 0.1F, 6553.5F, 700.049F, 700.051F, 1234.567F, 400, 6553.46F,  //
      std::numeric_limits<float>::quiet_NaN(), 0, -3, std::numeric_limits<float>::infinity();
  write_depth_image(folder / "d.png", z, kUnit);
  const cv::Mat image = cv::imread((folder / "d.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_16UC1);
  EXPECT_EQ(image.at<ushort>(0, 2), 65535);
  EXPECT_EQ(image.at<ushort>(0, 3), 7000);
  EXPECT_EQ(image.at<ushort>(1, 0), 7001);
  const geometry::RangeMap read = read_depth_image(folder / "d.png", kUnit, camera_of(4, 3));
  for (int row = 0; row < 2; ++row) {
    for (int col = 0; col < 4; ++col)
      EXPECT_NEAR(read.z(row, col), z(row, col), kUnit / 2 * (1 + 1e-3)) << row << ' ' << col;
  }
  EXPECT_EQ(cv::countNonZero(image.row(2)), 0);
  EXPECT_TRUE(read.z.row(2).isNaN().all());
}

TEST(DepthImage, IsNotWrittenIfDepthsDoNotFitAndSaysWhichUnitDoes) {
  const ScratchFolder folder;
  const auto refusal = [&](float depth, double unit) {
    return message_of<InvalidInput>([&] {
      write_depth_image(folder / "d.png", geometry::ImageF::Constant(2, 2, depth), unit);
    });
  };
  EXPECT_NE(refusal(7000, 0.1).find("a depth of 7000 mm is beyond 16 bits with units of 0.1 mm, "
                                    "which reach 6553.5 mm; units of 0.2 mm are long enough"),
            std::string::npos);
  EXPECT_NE(refusal(80'000, 1).find("units of 2 mm are long"), std::string::npos);
  EXPECT_NE(refusal(0.2F, 1).find("units of at most 0.2 mm are short enough"), std::string::npos);
  EXPECT_FALSE(refusal(700, 0).empty());
  EXPECT_FALSE(
      message_of<InvalidInput>([&] { write_depth_image(folder / "d.png", {}, 1); }).empty());
  EXPECT_FALSE(std::filesystem::exists(folder / "d.png"));
  write_depth_image(folder / "d.png", geometry::ImageF::Constant(2, 2, 7000), 0.2);
  EXPECT_TRUE(std::filesystem::exists(folder / "d.png"));
}

}  // namespace
}  // namespace palpate::sensing
