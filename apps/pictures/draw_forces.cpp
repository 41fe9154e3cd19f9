// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_forces.h"

#include <array>
#include <cmath>
#include <vector>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

/// Backgrounds of free, stick and slip.
constexpr std::array<Rgb, 3> kStateColors{{{255, 255, 255}, {219, 233, 246}, {253, 228, 202}}};

void check_input(const Eigen::Ref<const Eigen::VectorXd>& times,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                 const Eigen::Ref<const Eigen::VectorXi>& states) {
  refuse_unless(times.size() >= 2, "times", "at least two are needed");
  check_count(forces.cols(), times.size(), "forces");
  check_count(states.size(), times.size(), "states");
  for (Eigen::Index index = 0; index < times.size(); ++index) {
    const std::string place = "entry " + std::to_string(index);
    require([&] { return "times: " + place; }, times(index), finite(), "s");
    refuse_unless(index == 0 || times(index) >= times(index - 1), "times",
                  place + " is earlier than the one before");
    refuse_unless(states(index) >= 0 && states(index) < static_cast<int>(kStateColors.size()),
                  "states",
                  place + " is " + std::to_string(states(index)) +
                      ": 0 (free), 1 (stick) or 2 (slip) is needed");
  }
  check_some_finite(forces, "forces");
}

/// One rectangle for each run of one state.
void add_state_bands(Chart& chart, const Eigen::Ref<const Eigen::VectorXd>& times,
                     const Eigen::Ref<const Eigen::VectorXi>& states) {
  Eigen::Index begin = 0;
  for (Eigen::Index index = 1; index < times.size(); ++index) {
    if (states(index) != states(begin) || index + 1 == times.size()) {
      chart.add_band({times(begin), times(index)},
                     kStateColors[static_cast<std::size_t>(states(begin))]);
      begin = index;
    }
  }
}

std::string summary(const Eigen::Ref<const Eigen::VectorXd>& times,
                    const Eigen::Ref<const Eigen::VectorXi>& states, double largest) {
  std::array<double, kStateColors.size()> durations{};
  for (Eigen::Index index = 0; index + 1 < times.size(); ++index) {
    durations[static_cast<std::size_t>(states(index))] += times(index + 1) - times(index);
  }
  const double total = times(times.size() - 1) - times(0);
  const auto percent = [total](double duration) {
    return format_value(total > 0 ? 100 * duration / total : 0, 1) + " %";
  };
  return "largest " + format_value(largest, 0.01) + " N; free " + percent(durations[0]) +
         ", stick " + percent(durations[1]) + ", slip " + percent(durations[2]) + " of the time";
}

}  // namespace

void draw_forces(const std::filesystem::path& png, const Eigen::Ref<const Eigen::VectorXd>& times,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                 const Eigen::Ref<const Eigen::VectorXi>& states, const std::string& title) {
  check_input(times, forces, states);
  const Eigen::VectorXd norms = forces.colwise().norm();
  Axis y{kEmptySpan, "force (N)"};
  y.span.include(norms);
  // The largest of all is a norm.
  const std::string subtitle = summary(times, states, y.span.high);
  y.span.include(forces.reshaped());
  y.span.pad();

  Canvas canvas(kChartPictureHeight, title, subtitle);
  const std::vector<LegendEntry> legend{{"fx", kVermilion},
                                        {"fy", kGreen},
                                        {"fz", kBlue},
                                        {"magnitude", kBlack},
                                        {"free", kStateColors[0], Mark::patch},
                                        {"stick", kStateColors[1], Mark::patch},
                                        {"slip", kStateColors[2], Mark::patch}};
  const double width = Canvas::kWidth - 2 * kChartMargin;
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2}, width, legend);
  const double height = canvas.top() - kLegendHeight - kChartMargin;
  Chart chart(canvas, {kChartMargin, kChartMargin, width, height},
              {{times(0), times(times.size() - 1)}, "time (s)"}, y);
  add_state_bands(chart, times, states);
  chart.add_axes();
  chart.add_line(times, norms, kBlack, 3);
  for (Eigen::Index axis = 0; axis < forces.rows(); ++axis) {
    const Eigen::VectorXd component = forces.row(axis);
    chart.add_line(times, component, legend[static_cast<std::size_t>(axis)].color, 2);
  }
  canvas.write(png);
}

}  // namespace palpate::pictures
