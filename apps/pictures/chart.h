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

/// From `low` to `high`, both finite.
struct Span {
  double low = 0;
  double high = 0;

  /// Takes in the finite ones of `values`.
  void include(const Eigen::Ref<const Eigen::VectorXd>& values);
  /// Widens it a little, so that lines and markers keep off the frame; an end at zero stays there.
  void pad();
};

/// Takes in nothing yet.
inline constexpr Span kEmptySpan{HUGE_VAL, -HUGE_VAL};

struct Axis {
  Span span;
  std::string label;      ///< quantity and unit
  double least_step = 0;  ///< between two ticks: 1 where only whole numbers mean something
};

/// Axes with ticks, labels and a grid on a part of a canvas; data are then drawn into them.
class Chart {
 public:
  /// `box` holds all of the chart, numbers and labels too. The spans, not empty, are widened to
  /// whole ticks.
  Chart(Canvas& canvas, const Box& box, const Axis& x, const Axis& y);

  /// A rectangle behind the data, over the whole height.
  void add_band(const Span& x, const Rgb& color);
  /// The grid, the frame and the numbers: after the bands, before the data.
  void add_axes();
  void add_line(const Eigen::Ref<const Eigen::VectorXd>& x,
                const Eigen::Ref<const Eigen::VectorXd>& y, const Rgb& color, double width);
  void add_markers(const Eigen::Ref<const Eigen::VectorXd>& x,
                   const Eigen::Ref<const Eigen::VectorXd>& y, const Rgb& color, double size);

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

/// How an entry of a legend looks.
enum class Mark { line, dot, patch };

struct LegendEntry {
  std::string name;
  Rgb color;
  Mark mark = Mark::line;
};

/// The entries beside one another with their middle at `at`, in as many rows as fit `width`,
/// downwards.
void add_legend(Canvas& canvas, const Eigen::Vector2d& at, double width,
                const std::vector<LegendEntry>& entries);

}  // namespace palpate::pictures
