// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/trade_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "maker/html_text.h"

namespace palpate::apps {
namespace {

// [px] of the picture, and of its margins.
constexpr double kWidth = 720, kHeight = 420, kLeft = 80, kRight = 20, kTop = 20, kBottom = 60;

// Errors with a smaller relative difference are the same.
constexpr double kSame = 0.01;

// Returns the smallest number >= `value` that is 1, 2 or 5 times a power of ten, which is easy to
// read.
double round_up(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= value) return digit * power;
  return 10 * power;
}

/// Places on the picture.
struct Axes {
  double low = 0, high = 0;  // logarithms of the costs
  double top = 0;            // error

  [[nodiscard]] double x(double cost) const {
    return kLeft + (std::log10(cost) - low) / (high - low) * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double y(double error) const {
    return kHeight - kBottom - error / top * (kHeight - kTop - kBottom);
  }
};

Axes axes_of(const std::vector<TradeDot>& dots) {
  const auto [least, most] = std::ranges::minmax(dots, {}, &TradeDot::cost);
  const double error = std::ranges::max(dots, {}, &TradeDot::error).error;
  constexpr double kMargin = 0.1;  // decades
  return {std::log10(least.cost) - kMargin, std::log10(most.cost) + kMargin,
          error > 0 ? 1.05 * error : 1};
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     web::html_escaped(text));
}

std::string grid(const Axes& axes) {
  std::string svg;
  for (int power = static_cast<int>(std::floor(axes.low)); power <= axes.high; ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double cost = digit * std::pow(10, power);
      if (std::log10(cost) < axes.low || std::log10(cost) > axes.high) continue;
      const double x = axes.x(cost);
      svg += fmt::format("<path class=\"grid\" d=\"M{0:.1f} {1}V{2}\"/>\n", x, kTop,
                         kHeight - kBottom);
      svg += text_at(x, kHeight - kBottom + 18, "middle", fmt::format("{:g}", cost));
    }
  }
  constexpr int kLines = 5;
  const double step = round_up(axes.top / kLines);
  for (double error = 0; error <= axes.top; error += step) {
    svg += fmt::format("<path class=\"grid\" d=\"M{0} {1:.1f}H{2}\"/>\n", kLeft, axes.y(error),
                       kWidth - kRight);
    svg += text_at(kLeft - 8, axes.y(error) + 4, "end", fmt::format("{:g}", error));
  }
  return svg;
}

}  // namespace

std::vector<std::size_t> pareto_front(const std::vector<TradeDot>& dots) {
  std::vector<std::size_t> order(dots.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {},
                           [&](std::size_t i) { return std::pair(dots[i].cost, dots[i].error); });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (!(dots[i].error < (1 - kSame) * least)) continue;
    least = dots[i].error;
    front.push_back(i);
  }
  return front;
}

std::string trade_svg(const std::vector<TradeDot>& dots, const std::string& cost,
                      const std::string& error) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" font-family=\"sans-serif\" font-size=\"13\">\n"
      "<style>.grid{{stroke:#ddd}}.front{{stroke:#c33;fill:none;stroke-width:1.5}}"
      "circle{{fill:#357}}.best{{fill:#c33}}</style>\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#fff\"/>\n",
      kWidth, kHeight);
  if (dots.empty()) return svg + "</svg>\n";
  const Axes axes = axes_of(dots);
  svg += grid(axes);
  svg += text_at((kLeft + kWidth - kRight) / 2, kHeight - 15, "middle", cost);
  svg += fmt::format(
      "<text transform=\"translate(20 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kTop + kHeight - kBottom) / 2, web::html_escaped(error));
  std::string line;
  const std::vector<std::size_t> front = pareto_front(dots);
  for (const std::size_t i : front)
    line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", axes.x(dots[i].cost),
                        axes.y(dots[i].error));
  svg += fmt::format("<path class=\"front\" d=\"{}\"/>\n", line);
  for (std::size_t i = 0; i < dots.size(); ++i) {
    const bool is_best = std::ranges::find(front, i) != front.end();
    const double x = axes.x(dots[i].cost), y = axes.y(dots[i].error);
    svg += fmt::format("<circle{} cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"><title>{}</title></circle>\n",
                       is_best ? " class=\"best\"" : "", x, y, web::html_escaped(dots[i].name));
    svg += text_at(x + 7, y - 5, "start", std::to_string(i + 1));
  }
  return svg + "</svg>\n";
}

}  // namespace palpate::apps
