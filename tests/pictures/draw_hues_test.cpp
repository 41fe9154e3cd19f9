// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_hues.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

constexpr double kPi = std::numbers::pi;

/// Within the axes of the chart.
const Region kHuesPlot(110, 130, 1040, 480);

/// The colour of a pure hue on the picture.
const Rgb kGreenHue = {0, 204, 0};
const Rgb kBlueHue = {0, 0, 204};

HueDistribution make_hue(const std::string& name, double mean, double deviation) {
  HueDistribution hue{name, mean, deviation, Eigen::VectorXd::Zero(360)};
  hue.histogram[static_cast<Eigen::Index>(mean * 180 / kPi)] = 1;
  hue.histogram[(static_cast<Eigen::Index>(mean * 180 / kPi) + 30) % 360] = 1;
  return hue;
}

cv::Mat3b hues_picture(const std::vector<HueDistribution>& hues) {
  return draw_picture([&](const std::filesystem::path& png) { draw_hues(png, hues, "Hues"); });
}

TEST(DrawHues, EachColourStandsAtItsHueInItsHue) {
  const cv::Mat3b picture =
      hues_picture({make_hue("G", 2 * kPi / 3, 0.2), make_hue("B", 4 * kPi / 3, 0.2)});
  EXPECT_EQ(picture.size(), cv::Size(1200, 700));
  const auto top = [&](const Rgb& color) {
    const cv::Mat1b mask = mask_of(picture, color, 60, kHuesPlot);
    const cv::Rect box = box_of(mask);
    // Where the upper half of the curve lies.
    return center_of(mask.rowRange(box.y, box.y + box.height / 2)).x();
  };
  EXPECT_NEAR((top(kBlueHue) - top(kGreenHue)) / kHuesPlot.width, 120.0 / 360, 0.03);
}

TEST(DrawHues, AGaussianGoesAroundTheCircle) {
  const cv::Mat3b picture = hues_picture({make_hue("R", 0.02, 0.3)});
  const cv::Mat1b mask = mask_of(picture, {204, 0, 0}, 60, kHuesPlot);
  EXPECT_GT(cv::countNonZero(mask.colRange(0, 100).rowRange(0, 240)), 50);
  EXPECT_GT(cv::countNonZero(mask.colRange(940, 1040).rowRange(0, 240)), 50);
}

TEST(DrawHues, RefusesInputThatDoesNotFit) {
  std::vector<HueDistribution> hues;
  const auto attempt = [&](const std::filesystem::path& png) { draw_hues(png, hues, ""); };
  expect_refused(attempt, "hues: there is none");
  hues = {make_hue("G", 2, 0.1)};
  hues[0].histogram.setZero();
  expect_refused(attempt, "colour 'G': the histogram is empty");
  hues = {make_hue("G", 2, std::nan(""))};
  expect_refused(attempt, "colour 'G'");
}

}  // namespace
}  // namespace palpate::pictures
