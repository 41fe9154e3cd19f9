// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/image_plane.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::sensing {
namespace {

std::vector<Plane> planes_of(const cv::Mat& frame, bool transposed) {
  std::vector<Plane> planes;
  split_frame(frame, transposed, planes);
  return planes;
}

Mask lit(const std::vector<Plane>& channels, const LitOptions& options) {
  Mask mask;
  find_lit(channels, options, mask);
  return mask;
}

TEST(Planes, AreGreenRedBlueAsFractionsOfFullScale) {
  cv::Mat frame(2, 3, CV_8UC3, cv::Scalar(51, 102, 204));
  frame.at<cv::Vec3b>(1, 2) = {0, 255, 0};
  const auto planes = planes_of(frame, false);
  ASSERT_EQ(planes.size(), 3U);
  EXPECT_FLOAT_EQ(planes[0](0, 0), 0.4F);
  EXPECT_FLOAT_EQ(planes[1](0, 0), 0.8F);
  EXPECT_FLOAT_EQ(planes[2](0, 0), 0.2F);
  EXPECT_FLOAT_EQ(planes[0](1, 2), 1);
}

TEST(Planes, MayBeTransposedAndOfSixteenBit) {
  cv::Mat frame(2, 3, CV_16UC1, cv::Scalar(0));
  frame.at<ushort>(1, 2) = 65535;
  const auto planes = planes_of(frame, true);
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_EQ(planes[0].rows(), 3);
  EXPECT_FLOAT_EQ(planes[0](2, 1), 1);
  EXPECT_EQ(planes[0].sum(), 1);
}

TEST(Planes, OtherTypesAreRefused) {
  EXPECT_THROW((void)planes_of(cv::Mat(), false), InvalidInput);
  EXPECT_THROW((void)planes_of(cv::Mat(2, 3, CV_32FC1), false), InvalidInput);
  EXPECT_THROW((void)planes_of(cv::Mat(2, 3, CV_8UC4), false), InvalidInput);
}

TEST(Planes, LitAreasHaveTroughsFilledButKeepTheirBorders) {
  Plane image = Plane::Zero(20, 2);
  image.middleRows(5, 10) = 1;
  image.middleRows(8, 3) = 0.1F;  // a trough
  const Mask mask = lit({image}, {.colored = false, .radius = 2, .min_signal = 0.5});
  EXPECT_EQ(mask(9, 0), 1);
  EXPECT_EQ(mask(5, 0), 1);
  EXPECT_EQ(mask(4, 0), 0);
  EXPECT_EQ(mask(15, 0), 0);
}

TEST(Planes, LightOfNoColourIsNotTheProjectors) {
  const Plane one = Plane::Ones(9, 4);
  const std::vector<Plane> reddish = {0.3F * one, 0.9F * one, 0.2F * one};
  EXPECT_EQ(lit(reddish, {.radius = 2, .min_signal = 0.69})(4, 2), 1);
  EXPECT_EQ(lit(reddish, {.radius = 2, .min_signal = 0.71})(4, 2), 0);
  EXPECT_EQ(lit({one, one, one}, {.radius = 2, .min_signal = 0.01})(4, 2), 0);
  EXPECT_EQ(lit(reddish, {.colored = false, .radius = 2, .min_signal = 0.89})(4, 2), 1);
  EXPECT_EQ(lit(reddish, {.colored = false, .radius = 2, .min_signal = 0.91})(4, 2), 0);
}

Mask clipped_in(const std::vector<Plane>& channels) {
  Mask clipped = Mask::Ones(1, 1);  // of an earlier frame of another size
  find_clipped(channels, clipped);
  return clipped;
}

TEST(Saturation, FindsTheHighestValueOfEachDepthAndNoOther) {
  Plane values(1, 6);
  values << 1, 254.0F / 255, 65535.0F / 65535, 0.99F, 0, std::numeric_limits<float>::quiet_NaN();
  Mask expected(1, 6);
  expected << 1, 0, 1, 0, 0, 0;
  EXPECT_TRUE((clipped_in({values}) == expected).all());
}

TEST(Saturation, IsThatOfAnyChannel) {
  std::vector<Plane> channels(3, Plane::Constant(5, 7, 0.5F));
  for (int channel = 0; channel < 3; ++channel)
    channels[static_cast<std::size_t>(channel)](channel, 2 * channel) = 1;
  const Mask clipped = clipped_in(channels);
  ASSERT_EQ(clipped.rows(), 5);
  ASSERT_EQ(clipped.cols(), 7);
  EXPECT_EQ(clipped.cast<int>().sum(), 3);
  for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(clipped(channel, 2 * channel), 1);
}

}  // namespace
}  // namespace palpate::sensing
