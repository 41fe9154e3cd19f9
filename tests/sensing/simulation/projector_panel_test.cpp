// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/projector_panel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::sensing {
namespace {

geometry::Camera small_projector() {
  return {.width = 3, .height = 2, .fx = 10, .fy = 10, .cx = 1, .cy = 0.5};
}

TEST(ProjectorPanel, TurnsValuesIntoLight) {
  VirtualSensor sensor;
  sensor.projector_gamma = 2;
  sensor.projector_black = 0.1;
  const double expected = 0.1 + 0.9 * 0.36;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3, CV_32FC1, CV_32FC3}) {
    const double full = CV_MAT_DEPTH(type) == CV_8U    ? 255
                        : CV_MAT_DEPTH(type) == CV_16U ? 65535
                                                       : 1;
    const cv::Mat image(2, 3, type, cv::Scalar::all(0.6 * full));
    const cv::Mat light = panel_light(image, small_projector(), sensor, "panel");
    ASSERT_EQ(light.type(), CV_32FC3);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(light.at<cv::Vec3f>(1, 2)[c], expected, 1e-6);
  }
}

TEST(ProjectorPanel, InterpolatesBetweenCentresAndNotBeyond) {
  cv::Mat image(2, 3, CV_32FC3, cv::Scalar::all(0));
  image.at<cv::Vec3f>(0, 1)[0] = 0.8F;
  image.at<cv::Vec3f>(1, 2)[0] = 0.4F;
  EXPECT_FLOAT_EQ(light_at(image, {1, 0}, 0), 0.8F);
  EXPECT_FLOAT_EQ(light_at(image, {1, 0}, 1), 0);
  EXPECT_FLOAT_EQ(light_at(image, {1.25, 0.25}, 0), 0.75F * 0.75F * 0.8F + 0.25F * 0.25F * 0.4F);
  EXPECT_FLOAT_EQ(light_at(image, {2.5, 1.5}, 0), 0.4F);
  EXPECT_FLOAT_EQ(light_at(image, {-0.5, -0.5}, 0), 0);
}

}  // namespace
}  // namespace palpate::sensing
