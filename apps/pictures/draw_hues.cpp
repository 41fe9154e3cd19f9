// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_hues.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/core/require.h"

namespace palpate::pictures {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// A Gaussian narrower than this [degrees] would be a line without a width.
constexpr double kLeastDeviation = 0.2;

constexpr double kTick = 20;    ///< degrees
constexpr double kFarAway = 5;  ///< standard deviations

/// The chart is that much higher than the highest Gaussian, for its name.
constexpr double kRoomForNames = 1.1;

/// A colour of this hue that is dark enough for a white ground.
Rgb color_of_hue(double hue) {
  const auto channel = [hue](double peak) {
    const double away = std::abs(std::remainder(hue - peak, 2 * std::numbers::pi));
    const double light = std::clamp(2 - away * 3 / std::numbers::pi, 0.0, 1.0);
    constexpr double kDark = 0.8;
    return static_cast<unsigned char>(std::lround(255 * kDark * light));
  };
  constexpr double kThird = 2 * std::numbers::pi / 3;
  return {channel(0), channel(kThird), channel(2 * kThird)};
}

/// The beginning of the axis [degrees], at most 0: in the middle of the largest gap between the
/// colours, so that it cuts none of them.
double axis_begin(const std::vector<HueDistribution>& hues) {
  std::vector<double> means;
  means.reserve(hues.size() + 1);
  for (const HueDistribution& hue : hues) means.push_back(hue.mean * kDegrees);
  std::sort(means.begin(), means.end());
  means.push_back(means.front() + 360);
  double begin = 0, largest = 0;
  for (std::size_t i = 0; i + 1 < means.size(); ++i) {
    const double gap = means[i + 1] - means[i];
    if (gap <= largest) continue;
    largest = gap;
    begin = (means[i] + means[i + 1]) / 2;
  }
  // Whole ticks.
  return kTick * std::floor(begin / kTick) - 360;
}

/// Density [1/degree] of the Gaussian around the circle; NaN where it is negligible.
Eigen::VectorXd density(const HueDistribution& hue, const Eigen::VectorXd& degrees) {
  const double deviation = std::max(hue.deviation * kDegrees, kLeastDeviation);
  return degrees.unaryExpr([&](double at) {
    const double away = std::remainder(at - hue.mean * kDegrees, 360.0) / deviation;
    if (std::abs(away) > kFarAway) return std::nan("");
    return std::exp(-0.5 * away * away) / (deviation * std::sqrt(2 * std::numbers::pi));
  });
}

void check_input(const std::vector<HueDistribution>& hues) {
  refuse_unless(!hues.empty(), "hues", "there is none: at least one colour is needed");
  for (const HueDistribution& hue : hues) {
    const std::string what = "colour '" + hue.name + "'";
    require(what + ": mean", hue.mean, finite(), "rad");
    require(what + ": deviation", hue.deviation, at_least(0).finite(), "rad");
    refuse_unless(hue.histogram.size() > 0 && hue.histogram.allFinite() && hue.histogram.sum() > 0,
                  what.c_str(), "the histogram is empty");
  }
}

}  // namespace

void draw_hues(const std::filesystem::path& png, const std::vector<HueDistribution>& hues,
               const std::string& title) {
  check_input(hues);
  const double begin = axis_begin(hues);
  const Eigen::VectorXd degrees = Eigen::VectorXd::LinSpaced(7201, begin, begin + 360);
  Axis x{{begin, begin + 360}, "hue (degrees)", kTick};
  Axis y{{0, 0}, "density (1 / degree)"};
  std::vector<LegendEntry> legend;
  for (const HueDistribution& hue : hues) {
    y.span.include(density(hue, degrees));
    legend.push_back({hue.name, color_of_hue(hue.mean)});
  }
  y.span.high *= kRoomForNames;
  Canvas canvas(kChartPictureHeight, title, "thin: pixels; thick: the fitted Gaussian");
  const double top = canvas.top() - kLegendHeight;
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2},
             Canvas::kWidth - 2 * kChartMargin, legend);
  Chart chart(canvas,
              {kChartMargin, kChartMargin, Canvas::kWidth - 2 * kChartMargin, top - kChartMargin},
              x, y);
  chart.add_axes();
  for (std::size_t i = 0; i < hues.size(); ++i) {
    const Eigen::VectorXd& counts = hues[i].histogram;
    const double step = 360.0 / static_cast<double>(counts.size());
    // Round the circle from the beginning of the axis, and only where there are pixels.
    Eigen::VectorXd middles(counts.size()), heights(counts.size());
    const auto first = static_cast<Eigen::Index>(std::ceil((begin + 360) / step - 0.5));
    for (Eigen::Index bin = 0; bin < counts.size(); ++bin) {
      const Eigen::Index source = (first + bin) % counts.size();
      const bool is_far = counts(source) == 0 && counts((source + 1) % counts.size()) == 0 &&
                          counts((source + counts.size() - 1) % counts.size()) == 0;
      middles(bin) = (static_cast<double>(first + bin) + 0.5) * step - 360;
      // A peak of the histogram may rise above the Gaussians, for which the chart is made.
      heights(bin) =
          is_far ? std::nan("") : std::min(counts(source) / (counts.sum() * step), y.span.high);
    }
    chart.add_line(middles, heights, legend[i].color, 1);
    const Eigen::VectorXd gaussian = density(hues[i], degrees);
    chart.add_line(degrees, gaussian, legend[i].color, 3);
    const double mean = hues[i].mean * kDegrees;
    Span peak{0, 0};
    peak.include(heights);
    peak.include(gaussian);
    chart.add_text_above(mean - begin > 360 ? mean - 360 : mean, peak.high, hues[i].name);
  }
  canvas.write(png);
}

}  // namespace palpate::pictures
