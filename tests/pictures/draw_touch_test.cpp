// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_touch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Within the axes of the charts, whose left ends depend on their numbers by a few pixels.
const Region kPositions(110, 140, 1050, 260);
const Region kSpeeds(110, 510, 1050, 215);

/// An approach at 20 mm/s for 0.2 s, then at 5 mm/s for 0.2 s.
Touch slowed_approach() {
  Touch touch{Eigen::VectorXd::LinSpaced(401, 3, 3.4), Eigen::VectorXd(401), 3.2};
  for (int i = 0; i <= 400; ++i) touch.positions(i) = (i < 200 ? 20 : 5) * (touch.times(i) - 3.2);
  return touch;
}

cv::Mat3b touch_picture(const Touch& touch) {
  return draw_picture([&](const std::filesystem::path& png) { draw_touch(png, touch, "Touch"); });
}

TEST(DrawTouch, MarksTheTouchAtItsTime) {
  for (const double touched : {3.1, 3.3}) {
    Touch touch = slowed_approach();
    touch.touched = touched;
    const cv::Mat3b picture = touch_picture(touch);
    EXPECT_EQ(picture.size(), cv::Size(1200, 820));
    // The lower chart has the time alone.
    const double x = center_of(mask_of(picture, kVermilion, 60, kSpeeds)).x() / kSpeeds.width;
    EXPECT_NEAR(x, (touched - 3) / 0.4, 0.03);
  }
}

TEST(DrawTouch, ShowsWhereTheTipSlowsDown) {
  const cv::Mat3b picture = touch_picture(slowed_approach());
  const auto height = [&](const Region& plot, double fraction) {
    const Region column(plot.x + static_cast<int>(fraction * plot.width), plot.y, 6, plot.height);
    return center_of(mask_of(picture, kBlue, 60, column)).y();
  };
  const double before = height(kPositions, 0.1) - height(kPositions, 0.4);
  const double after = height(kPositions, 0.6) - height(kPositions, 0.9);
  EXPECT_NEAR(before / after, 4, 0.4);
  EXPECT_GT(after, 15);  // px upwards
  EXPECT_NEAR(height(kSpeeds, 0.15), height(kSpeeds, 0.4), 2);
  EXPECT_GT(height(kSpeeds, 0.8), height(kSpeeds, 0.4) + 90);
}

TEST(DrawTouch, RefusesInputThatDoesNotFit) {
  Touch touch = slowed_approach();
  const auto attempt = [&touch](const std::filesystem::path& png) { draw_touch(png, touch, ""); };
  touch.touched = 3.5;
  expect_refused(attempt, "touched: is not within the times");
  touch = slowed_approach();
  touch.times(7) = touch.times(6);
  expect_refused(attempt, "times: entry 7 is not after");
  touch = slowed_approach();
  touch.positions(3) = std::nan("");
  expect_refused(attempt, "positions: entry 3 is nan mm");
  touch.positions.conservativeResize(5);
  expect_refused(attempt, "positions: has 5 entries where 401 are needed");
  touch.times.conservativeResize(19);
  expect_refused(attempt, "times: has 19 entries where 20 or more are needed");
}

TEST(DrawTouch, SaysWhenItCannotWrite) {
  expect_unwritable(
      [](const std::filesystem::path& png) { draw_touch(png, slowed_approach(), ""); });
}

}  // namespace
}  // namespace palpate::pictures
