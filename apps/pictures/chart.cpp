// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "chart.h"

#include <algorithm>

namespace palpate::pictures {
namespace {

constexpr Rgb kGridColor{225, 225, 225};
constexpr double kNumberGap = 6;      ///< px between a tick and its number
constexpr double kLabelGap = 6;       ///< px between the numbers and the axis' label
constexpr double kLabelHeight = 22;   ///< px
constexpr double kNumberHeight = 18;  ///< px
constexpr double kPxPerXTick = 50;    ///< about, at least
constexpr double kPxPerYTick = 30;    ///< about, at least

/// Of the length of a span, at each end.
constexpr double kPadding = 0.03;

constexpr double kEntryGap = 28;     ///< px between the entries of a legend
constexpr double kMarkWidth = 26;    ///< px
constexpr double kMarkGap = 8;       ///< px between a mark and its name
constexpr double kDotSize = 10;      ///< px
constexpr double kPatchHeight = 16;  ///< px
constexpr double kRowHeight = 26;    ///< px

/// The span widened to whole ticks, so that data keep off the frame; and those ticks.
Ticks widen(Axis& axis, double px, double px_per_tick) {
  Span& span = axis.span;
  if (!(span.high > span.low)) {
    const double half = span.low == 0 ? 1 : std::abs(span.low) / 2;
    span = {span.low - half, span.high + half};
  }
  const int most = std::max(2, static_cast<int>(px / px_per_tick));
  const double step = std::max(make_ticks(span.low, span.high, most).step, axis.least_step);
  span = {step * std::floor(span.low / step), step * std::ceil(span.high / step)};
  Ticks ticks;
  ticks.step = step;
  const auto count = std::lround((span.high - span.low) / step);
  for (long index = 0; index <= count; ++index) {
    ticks.values.push_back(span.low + static_cast<double>(index) * step);
    ticks.labels.push_back(format_value(ticks.values.back(), step));
  }
  return ticks;
}

/// `at` is the left end of the mark, in its middle.
void add_mark(Canvas& canvas, const Eigen::Vector2d& at, const LegendEntry& entry) {
  switch (entry.mark) {
    case Mark::line:
      canvas.add_line(Eigen::Matrix2d{{at.x(), at.x() + kMarkWidth}, {at.y(), at.y()}}, entry.color,
                      entry.width);
      break;
    case Mark::dot:
      canvas.add_markers(at + Eigen::Vector2d(kMarkWidth / 2, 0), entry.color, kDotSize);
      break;
    case Mark::patch: {
      const Box patch{at.x(), at.y() - kPatchHeight / 2, kMarkWidth, kPatchHeight};
      canvas.add_rectangle(patch, entry.color);
      canvas.add_outline(patch);
      break;
    }
  }
}

}  // namespace

void Span::include(const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (const double value : values) {
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
}

void Span::pad() {
  const double room = kPadding * (high - low);
  low -= low == 0 ? 0 : room;
  high += high == 0 ? 0 : room;
}

Chart::Chart(Canvas& canvas, const Box& box, const Axis& x, const Axis& y)
    : canvas_(canvas), x_(x), y_(y), label_corner_(box.x, box.y), plot_(box) {
  const double below = kTickLength + kNumberGap + kNumberHeight + kLabelGap + kLabelHeight;
  plot_.y += below;
  plot_.height -= below + kNumberHeight / 2;
  y_ticks_ = widen(y_, plot_.height, kPxPerYTick);
  double widest = 0;
  for (const std::string& label : y_ticks_.labels) {
    widest = std::max(widest, canvas.text_size(label).x());
  }
  const double left = kLabelHeight + kLabelGap + widest + kNumberGap + kTickLength;
  plot_.x += left;
  plot_.width -= left;
  x_ticks_ = widen(x_, plot_.width, kPxPerXTick);
  // Half of the last number stands right of the frame.
  plot_.width -= canvas.text_size(x_ticks_.labels.back()).x() / 2;
}

double Chart::on_canvas_x(double value) const {
  return plot_.x + plot_.width * (value - x_.span.low) / (x_.span.high - x_.span.low);
}

double Chart::on_canvas_y(double value) const {
  return plot_.y + plot_.height * (value - y_.span.low) / (y_.span.high - y_.span.low);
}

Eigen::Matrix2Xd Chart::on_canvas(const Eigen::Ref<const Eigen::VectorXd>& x,
                                  const Eigen::Ref<const Eigen::VectorXd>& y) const {
  Eigen::Matrix2Xd points(2, x.size());
  for (Eigen::Index index = 0; index < x.size(); ++index) {
    points.col(index) << on_canvas_x(x(index)), on_canvas_y(y(index));
  }
  return points;
}

void Chart::add_band(const Span& x, const Rgb& color) {
  const double left = on_canvas_x(x.low);
  canvas_.add_rectangle({left, plot_.y, on_canvas_x(x.high) - left, plot_.height}, color);
}

void Chart::add_axes() {
  const double top = plot_.y + plot_.height;
  const double right = plot_.x + plot_.width;
  for (std::size_t index = 0; index < x_ticks_.values.size(); ++index) {
    const double x = on_canvas_x(x_ticks_.values[index]);
    canvas_.add_line(Eigen::Matrix2d{{x, x}, {plot_.y, top}}, kGridColor);
    canvas_.add_line(Eigen::Matrix2d{{x, x}, {plot_.y - kTickLength, plot_.y}}, kGrey);
    canvas_.add_text({x, plot_.y - kTickLength - kNumberGap}, x_ticks_.labels[index],
                     {.up = Align::high});
  }
  for (std::size_t index = 0; index < y_ticks_.values.size(); ++index) {
    const double y = on_canvas_y(y_ticks_.values[index]);
    canvas_.add_line(Eigen::Matrix2d{{plot_.x, right}, {y, y}}, kGridColor);
    canvas_.add_line(Eigen::Matrix2d{{plot_.x - kTickLength, plot_.x}, {y, y}}, kGrey);
    canvas_.add_text({plot_.x - kTickLength - kNumberGap, y}, y_ticks_.labels[index],
                     {.across = Align::high});
  }
  if (y_.span.low < 0 && y_.span.high > 0) {
    canvas_.add_line(Eigen::Matrix2d{{plot_.x, right}, {on_canvas_y(0), on_canvas_y(0)}}, kGrey);
  }
  canvas_.add_outline(plot_);
  canvas_.add_text({plot_.x + plot_.width / 2, label_corner_.y() + kLabelHeight / 2}, x_.label);
  canvas_.add_text({label_corner_.x() + kLabelHeight / 2, plot_.y + plot_.height / 2}, y_.label,
                   {.upwards = true});
}

void Chart::add_line(const Eigen::Ref<const Eigen::VectorXd>& x,
                     const Eigen::Ref<const Eigen::VectorXd>& y, const Rgb& color, double width) {
  canvas_.add_line(on_canvas(x, y), color, width);
}

void Chart::add_markers(const Eigen::Ref<const Eigen::VectorXd>& x,
                        const Eigen::Ref<const Eigen::VectorXd>& y, const Rgb& color, double size) {
  canvas_.add_markers(on_canvas(x, y), color, size);
}

void Chart::add_text_above(double x, double y, const std::string& text) {
  canvas_.add_text({on_canvas_x(x), on_canvas_y(y) + kNumberHeight / 2}, text, {.bold = true});
}

void add_legend(Canvas& canvas, const Eigen::Vector2d& at, double width,
                const std::vector<LegendEntry>& entries) {
  const TextStyle style{.across = Align::low};
  std::vector<std::vector<LegendEntry>> rows(1);
  std::vector<double> lengths{-kEntryGap};
  for (const LegendEntry& entry : entries) {
    const double length =
        kEntryGap + kMarkWidth + kMarkGap + canvas.text_size(entry.name, style).x();
    if (!rows.back().empty() && lengths.back() + length > width) {
      rows.emplace_back();
      lengths.push_back(-kEntryGap);
    }
    rows.back().push_back(entry);
    lengths.back() += length;
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double y = at.y() - static_cast<double>(row) * kRowHeight;
    double x = at.x() - lengths[row] / 2;
    for (const LegendEntry& entry : rows[row]) {
      add_mark(canvas, {x, y}, entry);
      x += kMarkWidth + kMarkGap;
      canvas.add_text({x, y}, entry.name, style);
      x += canvas.text_size(entry.name, style).x() + kEntryGap;
    }
  }
}

}  // namespace palpate::pictures
