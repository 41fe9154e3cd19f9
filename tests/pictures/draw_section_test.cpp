// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_section.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Within the axes of the chart.
const Region kSectionPlot(110, 112, 1040, 500);

std::vector<SectionSeries> make_series() {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(101, 0, 100);
  return {{"rising", x, x}, {"level", x, Eigen::VectorXd::Constant(101, 20)}};
}

cv::Mat3b section_picture(const std::vector<SectionSeries>& series) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_section(png, series, "A section"); });
}

TEST(DrawSection, LinesFollowTheData) {
  const cv::Mat3b picture = section_picture(make_series());
  EXPECT_EQ(picture.size(), cv::Size(1200, 700));
  const cv::Mat1b rising = mask_of(picture, kBlue, 60, kSectionPlot);
  const double left = center_of(rising.colRange(0, 50)).y();
  const double middle = center_of(rising.colRange(495, 545)).y();
  const double right = center_of(rising.colRange(990, 1040)).y();
  EXPECT_GT(left, middle + 150) << "upwards on the picture";
  EXPECT_NEAR(left - middle, middle - right, 4) << "a straight line";
}

TEST(DrawSection, AxesAreLinear) {
  std::vector<SectionSeries> series = make_series();
  for (const double height : {40.0, 80.0}) {
    series.push_back({"level", series[0].x, Eigen::VectorXd::Constant(101, height)});
  }
  const cv::Mat3b picture = section_picture(series);
  const auto height_of = [&picture](const Rgb& color) {
    return center_of(mask_of(picture, color, 40, kSectionPlot)).y();
  };
  const double first = height_of(kOrange) - height_of(kGreen);
  const double second = height_of(kGreen) - height_of(kPurple);
  EXPECT_NEAR(second / first, 2, 0.02) << "20, 40 and 80";
}

TEST(DrawSection, ChannelsHaveTheirOwnColours) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(101, 0, 100);
  std::vector<SectionSeries> series;
  for (const auto& [name, height] :
       {std::pair("blue", 20.0), std::pair("green", 50.0), std::pair("red", 80.0)})
    series.push_back({name, x, Eigen::VectorXd::Constant(101, height)});
  const cv::Mat3b picture = section_picture(series);
  const auto height_of = [&picture](const Rgb& color) {
    return center_of(mask_of(picture, color, 40, kSectionPlot)).y();
  };
  EXPECT_GT(height_of(kBlue), height_of(kGreen) + 50);
  EXPECT_GT(height_of(kGreen), height_of(kVermilion) + 50);
}

TEST(DrawSection, CoincidingLinesAreAllSeen) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(101, 0, 100);
  const cv::Mat3b picture = section_picture({{"blue", x, x}, {"green", x, x}, {"red", x, x}});
  for (const Rgb& color : {kBlue, kGreen, kVermilion})
    EXPECT_GT(cv::countNonZero(mask_of(picture, color, 40, kSectionPlot)), 1000);
}

TEST(DrawSection, NaNBreaksTheLine) {
  std::vector<SectionSeries> series = make_series();
  series[0].y.segment(40, 20).setConstant(std::nan(""));
  const cv::Mat3b picture = section_picture(series);
  EXPECT_EQ(cv::countNonZero(mask_of(picture, kBlue, 60, kSectionPlot).colRange(450, 590)), 0);
}

TEST(DrawSection, NamesAllSeriesEvenIfTheyAreMany) {
  std::vector<SectionSeries> series;
  for (int index = 0; index < 12; ++index) {
    series.push_back(make_series()[1]);
    series.back().y.array() += index;
    series.back().name = "a series with quite a long name";
  }
  const cv::Mat3b picture = section_picture(series);
  // Nothing runs off the paper.
  EXPECT_EQ(cv::countNonZero(255 - mask_of(picture, {255, 255, 255}, 12, {0, 0, 8, 700})), 0);
  EXPECT_EQ(cv::countNonZero(255 - mask_of(picture, {255, 255, 255}, 12, {1192, 0, 8, 700})), 0);
}

TEST(DrawSection, RefusesInputThatDoesNotFit) {
  std::vector<SectionSeries> series;
  const auto attempt = [&series](const std::filesystem::path& png) {
    draw_section(png, series, "");
  };
  expect_refused(attempt, "series: there is none");
  series = make_series();
  series[1].y.conservativeResize(100);
  expect_refused(attempt, "series 'level': y: has 100 entries where 101 are needed");
  series[1].y.setConstant(101, std::nan(""));
  expect_refused(attempt, "series 'level': y: holds no finite value");
  series[1] = {"none", {}, {}};
  expect_refused(attempt, "series 'none': x: is empty");
}

TEST(DrawSection, GivesTheSameBytesAgain) {
  expect_same_again(
      [](const std::filesystem::path& png) { draw_section(png, make_series(), "Again"); });
}

TEST(DrawSection, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) { draw_section(png, make_series(), ""); });
}

}  // namespace
}  // namespace palpate::pictures
