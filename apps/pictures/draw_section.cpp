// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_section.h"

#include <array>
#include <vector>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"

namespace palpate::pictures {
namespace {

constexpr double kLineWidth = 2;    ///< px, of the line on top
constexpr double kBroader = 2.5;    ///< px, from one line to the next below it
constexpr std::size_t kNested = 3;  ///< more lines all have the same width
constexpr std::array<Rgb, 6> kLineColors{kBlue, kOrange, kGreen, kPurple, kVermilion, kBlack};

Rgb color_of_line(const std::string& name, std::size_t index) {
  if (name == "red") return kVermilion;
  if (name == "green") return kGreen;
  if (name == "blue") return kBlue;
  if (name == "grey") return kGrey;
  return kLineColors[index % kLineColors.size()];
}

}  // namespace

void draw_section(const std::filesystem::path& png, std::span<const SectionSeries> series,
                  const std::string& title, const SectionLabels& labels) {
  refuse_unless(!series.empty(), "series", "there is none: at least one line is needed");
  Axis x{kEmptySpan, labels.x};
  Axis y{kEmptySpan, labels.y};
  std::vector<LegendEntry> legend;
  for (const SectionSeries& one : series) {
    check_count(one.y.size(), one.x.size(), ("series '" + one.name + "': y").c_str());
    check_some_finite(one.x, ("series '" + one.name + "': x").c_str());
    check_some_finite(one.y, ("series '" + one.name + "': y").c_str());
    x.span.include(one.x);
    y.span.include(one.y);
    const std::size_t below = series.size() <= kNested ? legend.size() : 0;
    legend.push_back({.name = one.name,
                      .color = color_of_line(one.name, legend.size()),
                      .width = kLineWidth + kBroader * static_cast<double>(below)});
  }
  y.span.pad();
  Canvas canvas(kChartPictureHeight, title, "");
  const double top = canvas.top() - kLegendHeight;
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2},
             Canvas::kWidth - 2 * kChartMargin, legend);
  Chart chart(canvas,
              {kChartMargin, kChartMargin, Canvas::kWidth - 2 * kChartMargin, top - kChartMargin},
              x, y);
  chart.add_axes();
  for (std::size_t index = series.size(); index-- > 0;) {
    chart.add_line(series[index].x, series[index].y, legend[index].color, legend[index].width);
  }
  canvas.write(png);
}

}  // namespace palpate::pictures
