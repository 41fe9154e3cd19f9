// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "planes.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "palpate/error.h"

namespace palpate::sensing {
namespace {

TEST(Planes, AreGreenRedBlueAsFractionsOfFullScale) {
  cv::Mat frame(2, 3, CV_8UC3, cv::Scalar(51, 102, 204));
  frame.at<cv::Vec3b>(1, 2) = {0, 255, 0};
  const auto planes = split_frame(frame, false);
  ASSERT_EQ(planes.size(), 3U);
  EXPECT_FLOAT_EQ(planes[0](0, 0), 0.4F);
  EXPECT_FLOAT_EQ(planes[1](0, 0), 0.8F);
  EXPECT_FLOAT_EQ(planes[2](0, 0), 0.2F);
  EXPECT_FLOAT_EQ(planes[0](1, 2), 1);
}

TEST(Planes, MayBeTransposedAndOfSixteenBit) {
  cv::Mat frame(2, 3, CV_16UC1, cv::Scalar(0));
  frame.at<ushort>(1, 2) = 65535;
  const auto planes = split_frame(frame, true);
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_EQ(planes[0].rows(), 3);
  EXPECT_FLOAT_EQ(planes[0](2, 1), 1);
  EXPECT_EQ(planes[0].sum(), 1);
}

TEST(Planes, OtherTypesAreRefused) {
  EXPECT_THROW((void)split_frame(cv::Mat(), false), InvalidInput);
  EXPECT_THROW((void)split_frame(cv::Mat(2, 3, CV_32FC1), false), InvalidInput);
  EXPECT_THROW((void)split_frame(cv::Mat(2, 3, CV_8UC4), false), InvalidInput);
}

TEST(Planes, LightHasTroughsFilledButKeepsItsBorders) {
  Plane image = Plane::Zero(20, 2);
  image.middleRows(5, 10) = 1;
  image.middleRows(8, 3) = 0.1F;  // a trough
  const Plane light = projector_light({image}, false, 2);
  EXPECT_EQ(light(9, 0), 1);
  EXPECT_EQ(light(5, 0), 1);
  EXPECT_EQ(light(4, 0), 0);
  EXPECT_EQ(light(15, 0), 0);
}

TEST(Planes, LightOfNoColourIsNotTheProjectors) {
  const Plane one = Plane::Ones(9, 4);
  const Plane light = projector_light({0.3F * one, 0.9F * one, 0.2F * one}, true, 2);
  EXPECT_FLOAT_EQ(light(4, 2), 0.7F);
  EXPECT_FLOAT_EQ(projector_light({one, one, one}, true, 2)(4, 2), 0);
  EXPECT_FLOAT_EQ(projector_light({0.3F * one, 0.9F * one, 0.2F * one}, false, 2)(4, 2), 0.9F);
}

}  // namespace
}  // namespace palpate::sensing
