// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_touch.h"

#include <cmath>
#include <string>
#include <vector>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr int kTouchHeight = 820;
constexpr double kPositionShare = 0.55;   ///< of the height, for the upper chart
constexpr Eigen::Index kLinePoints = 20;  ///< of a speed

void check_touch(const Touch& touch) {
  const Eigen::Index count = touch.times.size();
  refuse_unless(count >= kLinePoints, "times",
                "has " + std::to_string(count) + " entries where 20 or more are needed");
  check_count(touch.positions.size(), count, "positions");
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::string place = "entry " + std::to_string(i);
    require([&] { return "times: " + place; }, touch.times(i), finite(), "s");
    require([&] { return "positions: " + place; }, touch.positions(i), finite(), "mm");
    refuse_unless(i == 0 || touch.times(i) > touch.times(i - 1), "times",
                  place + " is not after the one before");
  }
  refuse_unless(touch.touched >= touch.times(0) && touch.touched <= touch.times(count - 1),
                "touched", "is not within the times");
}

/// [mm/s] by a line through the positions around each time; NaN near the ends.
Eigen::VectorXd line_speeds(const Touch& touch) {
  const Eigen::Index count = touch.times.size(), half = kLinePoints / 2;
  Eigen::VectorXd speeds = Eigen::VectorXd::Constant(count, std::nan(""));
  for (Eigen::Index i = half; i + half <= count; ++i) {
    const auto times = touch.times.segment(i - half, kLinePoints).array();
    const auto positions = touch.positions.segment(i - half, kLinePoints).array();
    const Eigen::ArrayXd centred = times - times.mean();
    speeds(i) = (centred * positions).sum() / centred.square().sum();
  }
  return speeds;
}

}  // namespace

void draw_touch(const std::filesystem::path& png, const Touch& touch, const std::string& title) {
  check_touch(touch);
  const Eigen::Index count = touch.times.size();
  const Eigen::VectorXd seconds = touch.times.array() - touch.times(0);
  const double touched = touch.touched - touch.times(0), certain = seconds(count - 1);
  Canvas canvas(kTouchHeight, title,
                "surface after " + format_value(touched, 0.001) + " s; certain " +
                    format_value(1000 * (certain - touched), 1) + " ms and " +
                    format_value(touch.positions(count - 1), 0.01) + " mm later");
  const double width = Canvas::kWidth - 2 * kChartMargin;
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2}, width,
             {{"measured", kBlue}, {"found: time and place of the touch", kVermilion}});

  const double height = canvas.top() - kLegendHeight - kChartMargin;
  const Axis time{{0, certain}, "time (s)"};
  const Eigen::VectorXd speeds = line_speeds(touch);
  Axis position{{0, 0}, "position from the surface (mm)"}, speed{{0, 0}, "speed (mm/s)"};
  position.span.include(touch.positions);
  position.span.pad();
  speed.span.include(speeds);
  speed.span.pad();
  const double lower_height = (1 - kPositionShare) * height;
  Chart upper(canvas, {kChartMargin, kChartMargin + lower_height, width, kPositionShare * height},
              time, position);
  Chart lower(canvas, {kChartMargin, kChartMargin, width, lower_height}, time, speed);
  upper.add_axes();
  lower.add_axes();
  const Eigen::Vector2d at(touched, touched), whole(0, certain);
  upper.add_line(at, Eigen::Vector2d(position.span.low, position.span.high), kVermilion, 2);
  upper.add_line(whole, Eigen::Vector2d::Zero(), kVermilion, 2);
  lower.add_line(at, Eigen::Vector2d(speed.span.low, speed.span.high), kVermilion, 2);
  upper.add_line(seconds, touch.positions, kBlue, 3);
  lower.add_line(seconds, speeds, kBlue, 3);
  canvas.write(png);
}

}  // namespace palpate::pictures
