// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_hues.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/require.h"

namespace palpate::pictures {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// A Gaussian narrower than this [degrees] would be a line without a width.
constexpr double kLeastDeviation = 0.2;

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

/// Density [1/degree] of the Gaussian around the circle.
Eigen::VectorXd density(const HueDistribution& hue, const Eigen::VectorXd& degrees) {
  const double deviation = std::max(hue.deviation * kDegrees, kLeastDeviation);
  return degrees.unaryExpr([&](double at) {
    const double away = std::remainder(at - hue.mean * kDegrees, 360.0) / deviation;
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
  const Eigen::VectorXd degrees = Eigen::VectorXd::LinSpaced(3601, 0, 360);
  Axis x{{0, 360}, "hue (degrees)"};
  Axis y{{0, 0}, "density (1 / degree)"};
  std::vector<LegendEntry> legend;
  for (const HueDistribution& hue : hues) {
    y.span.include(density(hue, degrees));
    legend.push_back({hue.name, color_of_hue(hue.mean)});
  }
  y.span.pad();
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
    const Eigen::VectorXd middles =
        Eigen::VectorXd::LinSpaced(counts.size(), step / 2, 360 - step / 2);
    // A peak of the histogram may rise above the Gaussians, for which the chart is made.
    const Eigen::VectorXd heights = (counts / (counts.sum() * step)).cwiseMin(y.span.high);
    chart.add_line(middles, heights, legend[i].color, 1);
    chart.add_line(degrees, density(hues[i], degrees), legend[i].color, 3);
  }
  canvas.write(png);
}

}  // namespace palpate::pictures
