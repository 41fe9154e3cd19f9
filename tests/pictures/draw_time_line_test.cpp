// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_time_line.h"

#include <gtest/gtest.h>

#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Within the axes of the charts, whose left ends depend on their numbers by a few pixels.
const Region kUpperPlot(110, 140, 1050, 195);
const Region kLowerPlot(110, 440, 1050, 290);

/// 100 trials at 10 contacts in 2 h: all hold in the first hour, all slip in the second.
TimeLine campaign() {
  TimeLine line{Eigen::VectorXd::LinSpaced(100, 0.02, 2), {}, Eigen::VectorXi(100)};
  for (int i = 0; i < 100; ++i) {
    line.kinds.push_back(i < 50 ? TrialKind::held : TrialKind::slipped);
    line.contacts(i) = i / 10;
  }
  return line;
}

cv::Mat3b time_line_picture(const TimeLine& line) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_time_line(png, line, "Campaign"); });
}

/// Pixels of a colour in the part of a plot between two fractions of its width.
int pixels_between(const cv::Mat3b& picture, const Region& plot, const Rgb& color, double from,
                   double to) {
  const Region part(plot.x + static_cast<int>(from * plot.width), plot.y,
                    static_cast<int>((to - from) * plot.width), plot.height);
  return cv::countNonZero(mask_of(picture, color, 60, part));
}

TEST(DrawTimeLine, MarksEachTrialAtItsTimeInTheColourOfItsOutcome) {
  const cv::Mat3b picture = time_line_picture(campaign());
  EXPECT_EQ(picture.size(), cv::Size(1200, 820));
  EXPECT_GT(pixels_between(picture, kLowerPlot, kBlue, 0, 0.48), 500);
  EXPECT_EQ(pixels_between(picture, kLowerPlot, kBlue, 0.55, 1), 0);
  EXPECT_EQ(pixels_between(picture, kLowerPlot, kVermilion, 0, 0.45), 0);
  EXPECT_GT(pixels_between(picture, kLowerPlot, kVermilion, 0.52, 1), 500);
}

TEST(DrawTimeLine, LaterContactsAreHigher) {
  const cv::Mat3b picture = time_line_picture(campaign());
  const cv::Mat1b held = mask_of(picture, kBlue, 60, kLowerPlot);
  const cv::Mat1b slipped = mask_of(picture, kVermilion, 60, kLowerPlot);
  EXPECT_LT(center_of(slipped).y(), center_of(held).y() - 60);
}

TEST(DrawTimeLine, CountsTheTrialsSoFar) {
  const cv::Mat3b picture = time_line_picture(campaign());
  // The line of the held trials rises in the first half and is level in the second.
  const auto height = [&](double fraction) {
    const Region column(kUpperPlot.x + static_cast<int>(fraction * kUpperPlot.width), kUpperPlot.y,
                        4, kUpperPlot.height);
    return center_of(mask_of(picture, kBlue, 60, column)).y();
  };
  EXPECT_GT(height(0.1), height(0.4) + 30);
  EXPECT_NEAR(height(0.6), height(0.95), 2);
}

TEST(DrawTimeLine, DrawsASingleTrialOfNoDuration) {
  TimeLine line{Eigen::VectorXd::Zero(1), {TrialKind::failed}, Eigen::VectorXi::Zero(1)};
  EXPECT_EQ(time_line_picture(line).size(), cv::Size(1200, 820));
}

TEST(DrawTimeLine, RefusesInputThatDoesNotFit) {
  TimeLine line = campaign();
  const auto attempt = [&line](const std::filesystem::path& png) { draw_time_line(png, line, ""); };
  line.hours(9) = 0;
  expect_refused(attempt, "hours: trial 9 is earlier");
  line.hours(9) = std::nan("");
  expect_refused(attempt, "hours: trial 9 is nan h; it must be");
  line = campaign();
  line.contacts(3) = -1;
  expect_refused(attempt, "contacts: trial 3 has a negative number");
  line.contacts.conservativeResize(5);
  expect_refused(attempt, "contacts: has 5 entries where 100 are needed");
  line.kinds.pop_back();
  expect_refused(attempt, "kinds: has 99 entries where 100 are needed");
  line = {};
  expect_refused(attempt, "hours: is empty");
}

TEST(DrawTimeLine, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) { draw_time_line(png, campaign(), ""); });
}

}  // namespace
}  // namespace palpate::pictures
