// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/color_overlap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// Share of a standard Gaussian above x.
double tail(double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); }

TEST(ColorOverlap, IsTheTailOfTheGaussianBeyondTheMiddle) {
  // Two colours of one width, 0.6 rad apart, on both sides of the wrap: decided in the middle, and
  // on the far side of the circle, where neither has any hues.
  const TrainedColors trained{
      {{"A", 0.2, 0.04, 1000}, {"B", 2 * std::numbers::pi - 0.4, 0.04, 1000}}};
  const Eigen::MatrixXd overlap = predict_overlap(trained);
  // The classifier's table has 1024 steps: the border may lie half of one off.
  EXPECT_NEAR(overlap(0, 1), tail(0.3 / 0.2), 0.003);
  EXPECT_NEAR(overlap(1, 0), tail(0.3 / 0.2), 0.003);
  EXPECT_NEAR(overlap.row(0).sum(), 1, 1e-12);
}

TEST(ColorOverlap, ColoursFarApartAreNeverMistaken) {
  TrainedColors trained;
  for (int i = 0; i < 6; ++i)
    trained.colors.push_back({std::to_string(i), i * std::numbers::pi / 3, 0.01, 1000});
  const Eigen::MatrixXd overlap = predict_overlap(trained);
  EXPECT_TRUE(overlap.isApprox(Eigen::MatrixXd::Identity(6, 6), 1e-5));
  EXPECT_TRUE(find_confused(overlap, 0.01).empty());
}

TEST(ColorOverlap, AWideColourIsTakenForANarrowOneMoreOftenThanTheOtherWay) {
  const TrainedColors trained{{{"wide", 1, 0.16, 1000}, {"narrow", 1.5, 0.01, 1000}}};
  const Eigen::MatrixXd overlap = predict_overlap(trained);
  EXPECT_GT(overlap(0, 1), 3 * overlap(1, 0));
  const auto confused = find_confused(overlap, 0.05);
  ASSERT_FALSE(confused.empty());
  EXPECT_EQ(confused[0].first, 0);
  EXPECT_EQ(confused[0].second, 1);
  EXPECT_EQ(confused[0].probability, overlap(0, 1));
}

/// An image whose hues are those of a Gaussian; |hue| well below pi / 3.
NamedImages gaussian_hues(const std::string& name, double mean, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> hue(mean, deviation);
  cv::Mat image(100, 200, CV_16UC3);
  for (auto& pixel : cv::Mat_<cv::Vec<ushort, 3>>(image)) {
    const double lean = std::clamp(hue(random) / (std::numbers::pi / 3), -1.0, 1.0);
    pixel = {static_cast<ushort>(std::lround(60000 * std::max(-lean, 0.0))),
             static_cast<ushort>(std::lround(60000 * std::max(lean, 0.0))), 60000};
  }
  return {name, {image}};
}

TEST(ColorOverlap, MeasuredAgreesWithPredicted) {
  const std::vector<NamedImages> images = {gaussian_hues("A", -0.2, 0.15, 1),
                                           gaussian_hues("B", 0.2, 0.15, 2)};
  const TrainedColors trained = train_colors(images);
  const Eigen::MatrixXd measured = measure_overlap(images, trained);
  // 20,000 pixels, 9 % of them mistaken: 0.2 % of sampling noise.
  EXPECT_TRUE(measured.isApprox(predict_overlap(trained), 0.01));
  EXPECT_NEAR(measured(0, 1), tail(0.2 / 0.15), 0.01);
  EXPECT_NEAR(measured.row(1).sum(), 1, 1e-12);
}

TEST(ColorOverlap, HistogramsCountThePixelsThatTrain) {
  const NamedImages images = gaussian_hues("A", 0.2, 0.1, 1);
  const Eigen::VectorXd histogram = hue_histogram(images, 36);
  EXPECT_EQ(histogram.sum(), static_cast<double>(train_colors({images}).colors[0].pixels));
  Eigen::Index largest = 0;
  histogram.maxCoeff(&largest);
  EXPECT_EQ(largest, 1) << "10 to 20 degrees";
  EXPECT_THROW((void)hue_histogram(images, 0), InvalidInput);
}

TEST(ColorOverlap, RefusesWrongInput) {
  EXPECT_THROW((void)predict_overlap({}), InvalidInput);
  EXPECT_THROW((void)predict_overlap({{{"A", std::nan(""), 0.1, 10}}}), InvalidInput);
  EXPECT_THROW((void)predict_overlap({{{"A", 1, -0.1, 10}}}), InvalidInput);
  const TrainedColors trained{{{"A", 1, 0.1, 10}}};
  EXPECT_NE(message_of<InvalidInput>([&] {
              (void)measure_overlap({gaussian_hues("B", 0.2, 0.1, 1)}, trained);
            }).find("colour B"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
