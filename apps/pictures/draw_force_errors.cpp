// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_force_errors.h"

#include <cmath>
#include <string>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr double kErrorMarkSize = 7;  ///< px

void check_force_errors(const ForceErrors& errors) {
  refuse_unless(errors.commanded.size() > 0, "commanded", "is empty: there is nothing to draw");
  check_count(errors.gravity_only.size(), errors.commanded.size(), "gravity_only");
  check_count(errors.fully_compensated.size(), errors.commanded.size(), "fully_compensated");
  for (Eigen::Index i = 0; i < errors.commanded.size(); ++i) {
    const std::string place = "force " + std::to_string(i);
    require([&] { return "commanded: " + place; }, errors.commanded(i), finite(), "N");
    require([&] { return "gravity_only: " + place; }, errors.gravity_only(i), finite(), "N");
    require([&] { return "fully_compensated: " + place; }, errors.fully_compensated(i), finite(),
            "N");
  }
}

double deviation_of(const Eigen::VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

}  // namespace

void draw_force_errors(const std::filesystem::path& png, const ForceErrors& errors,
                       const std::string& title) {
  check_force_errors(errors);
  constexpr double kResolution = 0.0001;  // [N] of the numbers in the subtitle
  Canvas canvas(kChartPictureHeight, title,
                "standard deviation " +
                    format_value(deviation_of(errors.gravity_only), kResolution) +
                    " N with gravity compensated, " +
                    format_value(deviation_of(errors.fully_compensated), kResolution) +
                    " N with internal forces too");
  const double width = Canvas::kWidth - 2 * kChartMargin;
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2}, width,
             {{"gravity compensated", kVermilion, Mark::dot},
              {"internal forces compensated too", kBlue, Mark::dot}});
  Axis force{kEmptySpan, "commanded force (N)"}, error{kEmptySpan, "applied less commanded (N)"};
  force.span.include(errors.commanded);
  force.span.pad();
  error.span.include(errors.gravity_only);
  error.span.include(errors.fully_compensated);
  error.span.include(Eigen::VectorXd::Zero(1));
  error.span.pad();
  Chart chart(canvas,
              {kChartMargin, kChartMargin, width, canvas.top() - kLegendHeight - kChartMargin},
              force, error);
  chart.add_axes();
  const Eigen::Vector2d ends(force.span.low, force.span.high);
  chart.add_line(ends, Eigen::Vector2d::Zero(), kBlack, 2);
  chart.add_markers(errors.commanded, errors.gravity_only, kVermilion, kErrorMarkSize);
  chart.add_markers(errors.commanded, errors.fully_compensated, kBlue, kErrorMarkSize);
  canvas.write(png);
}

}  // namespace palpate::pictures
