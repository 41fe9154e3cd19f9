// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/crosstalk_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/sensing/decode.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

/// Rows: the camera's red, green, blue.
const Eigen::Matrix3d kMixing =
    (Eigen::Matrix3d() << 1, 0.2, 0.05, 0.1, 1, 0.2, 0, 0.15, 1).finished();

/// Image of a camera with these filters, from a BGR image that separates the projector's colours.
cv::Mat mixed(const cv::Mat& separate) {
  cv::Mat image = separate.clone();
  for (auto& pixel : cv::Mat_<cv::Vec<ushort, 3>>(image)) {
    const Eigen::Vector3d light = kMixing * Eigen::Vector3d(pixel[2], pixel[1], pixel[0]);
    pixel = {cv::saturate_cast<ushort>(light[2]), cv::saturate_cast<ushort>(light[1]),
             cv::saturate_cast<ushort>(light[0])};
  }
  return image;
}

/// A brownish surface in some ambient light.
cv::Mat flat(double red, double green, double blue) {
  cv::Mat image(48, 64, CV_16UC3,
                cv::Scalar(2000 + 9000 * blue, 2000 + 14000 * green, 2000 + 25000 * red));
  return mixed(image);
}

CrosstalkImages flats() { return {flat(0, 0, 0), flat(1, 0, 0), flat(0, 1, 0), flat(0, 0, 1)}; }

TEST(CrosstalkCalibration, FindsTheFiltersWhateverColourTheSurfaceHas) {
  const CrosstalkCalibration found = calibrate_crosstalk(flats());
  EXPECT_LT((found.mixing - kMixing).cwiseAbs().maxCoeff(), 2e-4);  // rounding to 16 bits
  EXPECT_EQ(found.pixels, 48 * 64);
  EXPECT_LT(found.deviation.maxCoeff(), 1e-9);
}

TEST(CrosstalkCalibration, LeavesOutOverexposedPixelsAndStatesTheScatter) {
  CrosstalkImages images = flats();
  for (cv::Mat* image : {&images.red, &images.green})
    (*image)(cv::Rect(0, 0, 16, 48)).setTo(cv::Scalar::all(65535));
  cv::Mat_<cv::Vec<ushort, 3>> green(images.green);
  for (int row = 0; row < 24; ++row)
    for (int column = 16; column < 64; ++column) green(row, column)[0] += 1400;  // 10 % into blue
  const CrosstalkCalibration found = calibrate_crosstalk(images);
  EXPECT_EQ(found.pixels, 48 * 48);
  EXPECT_NEAR(found.mixing(2, 1), 0.15 + 0.05, 2e-4);
  EXPECT_NEAR(found.deviation(2, 1), 0.05 / std::sqrt(11), 1e-3);  // of 12 parts, +-0.05
}

TEST(CrosstalkCalibration, RefusesImagesThatDoNotTellTheFilters) {
  const auto refusal_of = [](const CrosstalkImages& images) {
    return message_of<InvalidInput>(
        [&] { (void)calibrate_crosstalk(images, {.min_signal = 0.01}); });
  };
  CrosstalkImages images = flats();
  std::swap(images.red, images.green);
  EXPECT_THAT(refusal_of(images), HasSubstr("exchanged"));
  images = flats();
  images.blue = images.off;
  EXPECT_THAT(refusal_of(images), HasSubstr("pixels"));
  images = flats();
  images.red = images.red.rowRange(0, 20);
  EXPECT_THAT(refusal_of(images), HasSubstr("red: has another size"));
  images = flats();
  cv::extractChannel(flats().off, images.off, 0);
  EXPECT_THAT(refusal_of(images), HasSubstr("off"));
}

TEST(CrosstalkCalibration, ARigWithItMeasuresAsIfTheFiltersDidNotOverlap) {
  Rig rig = make_rig(false);
  rig.red = {.alpha = 1.002, .beta = 1.004, .gamma = 0};
  rig.blue = {.alpha = 0.998, .beta = 0.996, .gamma = 0};
  Pattern pattern = make_pattern(Axis::y, 20, 1024);
  pattern.colors.clear();
  pattern.stripes.clear();
  pattern.stripe_edges.clear();
  const Scene scene = render(rig, pattern, plane({0, 0, 1}, 700), 0.02, 0.4);
  const auto median_error = [&](const Rig& with, const cv::Mat& frame) {
    const DecodeResult result =
        Decoder(with, pattern, {}, {.anchors = {Anchor{160, 120, 700}}}).decode(frame);
    std::vector<float> errors;
    for (long i = 0; i < result.range.z.size(); ++i) {
      if (result.range.z.data()[i] > 0) errors.push_back(std::abs(result.range.z.data()[i] - 700));
    }
    EXPECT_GT(errors.size(), 60000U);
    std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2),
                     errors.end());
    return errors[errors.size() / 2];
  };
  const float separate = median_error(rig, scene.frame);
  const float ignored = median_error(rig, mixed(scene.frame));
  rig.color_mixing = kMixing;
  EXPECT_LT(median_error(rig, mixed(scene.frame)), 1.2F * separate);
  EXPECT_GT(ignored, 3 * separate) << "the test shows nothing";
}

}  // namespace
}  // namespace palpate::sensing
