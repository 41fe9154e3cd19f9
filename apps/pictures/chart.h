// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "canvas.h"
#include "ticks.h"

namespace palpate::pictures {

/// An interval; both ends are finite.
struct Span {
  double low = 0;
  double high = 0;

  /// Extends the span to the finite values.
  void include(const Eigen::Ref<const Eigen::VectorXd>& values);
  /// Extends the span slightly, so that lines and markers do not touch the frame; an end at zero
  /// stays.
  void pad();
};

/// A span without any value.
inline constexpr Span kEmptySpan{HUGE_VAL, -HUGE_VAL};

struct Axis {
  Span span;
  std::string label;      ///< quantity and unit
  double least_step = 0;  ///< smallest distance of ticks: 1 if only whole numbers make sense
};

/// Layout of a picture that is a chart below its legend, px.
inline constexpr int kChartPictureHeight = 700;
inline constexpr double kChartMargin = 24;
inline constexpr double kLegendHeight = 44;

/// A chart with axes, ticks, labels and a grid on a part of a canvas.
class Chart {
 public:
  /// `box` contains the whole chart with its numbers and labels. The spans must not be empty; they
  /// are extended to whole ticks.
  Chart(Canvas& canvas, const Box& box, const Axis& x, const Axis& y);

  /// Draws a rectangle behind the data, over the whole height.
  void add_band(const Span& x, const Rgb& color);
  /// Draws the grid, the frame and the numbers. Call it after the bands and before the data.
  void add_axes();
  void add_line(const Eigen::Ref<const Eigen::VectorXd>& x,
                const Eigen::Ref<const Eigen::VectorXd>& y, const Rgb& color, double width);
  void add_markers(const Eigen::Ref<const Eigen::VectorXd>& x,
                   const Eigen::Ref<const Eigen::VectorXd>& y, const Rgb& color, double size);
  /// Writes a text above a point of the chart.
  void add_text_above(double x, double y, const std::string& text);

 private:
  [[nodiscard]] double on_canvas_x(double value) const;
  [[nodiscard]] double on_canvas_y(double value) const;
  [[nodiscard]] Eigen::Matrix2Xd on_canvas(const Eigen::Ref<const Eigen::VectorXd>& x,
                                           const Eigen::Ref<const Eigen::VectorXd>& y) const;

  Canvas& canvas_;
  Axis x_;
  Axis y_;
  Ticks x_ticks_;
  Ticks y_ticks_;
  Eigen::Vector2d label_corner_;
  Box plot_;  // between the axes
};

/// Symbol of a legend entry.
enum class Mark { line, dot, patch };

struct LegendEntry {
  std::string name;
  Rgb color;
  Mark mark = Mark::line;
  double width = 3;  ///< px, of a line
};

/// Draws the entries side by side, centred at `at`, in as many rows as needed for `width`, from top
/// to bottom.
void add_legend(Canvas& canvas, const Eigen::Vector2d& at, double width,
                const std::vector<LegendEntry>& entries);

}  // namespace palpate::pictures
