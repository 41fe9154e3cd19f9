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
    // The middle of the upper half of the curve.
    return center_of(mask.rowRange(box.y, box.y + box.height / 2)).x();
  };
  EXPECT_NEAR((top(kBlueHue) - top(kGreenHue)) / kHuesPlot.width, 120.0 / 360, 0.03);
}

TEST(DrawHues, AxisBeginsWhereNoColourIsCut) {
  // Red lies at 0 degrees and goes around the circle.
  const cv::Mat3b picture =
      hues_picture({make_hue("R", 0.02, 0.3), make_hue("G", 2 * std::numbers::pi / 3, 0.2)});
  const cv::Mat1b mask = mask_of(picture, {204, 0, 0}, 60, kHuesPlot);
  const cv::Rect box = box_of(mask);
  EXPECT_GT(box.x, 50);
  EXPECT_LT(box.x + box.width, kHuesPlot.width - 50);
  // The Gaussian's two sides, of two standard deviations or 34 degrees each.
  const double middle = center_of(mask.rowRange(box.y, box.y + 20)).x();
  const cv::Mat1b lower = mask.rowRange(box.y + box.height / 2, box.y + box.height - 20);
  EXPECT_GT(cv::countNonZero(lower.colRange(0, static_cast<int>(middle))), 50);
  EXPECT_GT(cv::countNonZero(lower.colRange(static_cast<int>(middle), lower.cols)), 50);
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
