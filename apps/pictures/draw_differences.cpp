// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_differences.h"

#include <algorithm>
#include <cmath>

#include "false_color_image.h"
#include "input_checks.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

/// The colours span this many medians of the absolute errors: nearly all of a Gaussian.
constexpr double kMedians = 4;
/// [mm] the colours span at least this, also where all errors are zero.
constexpr double kLeastLimit = 1e-3;

/// Limit of the colours [mm], of two digits.
double limit_of(const geometry::ErrorStatistics& error) {
  const double limit = std::max(error.count > 0 ? kMedians * error.median : 0, kLeastLimit);
  const double unit = std::pow(10, std::floor(std::log10(limit)) - 1);
  return unit * std::round(limit / unit);
}

std::string figures_of(const geometry::RangeMapScore& score) {
  std::string text = std::isnan(score.coverage)
                         ? ""
                         : "coverage " + format_value(100 * score.coverage, 0.1) + " %, ";
  text += "wrong " + format_value(100 * score.wrong_share, 0.01) + " %";
  if (score.error.count == 0) return text;
  return text + "; error of the others: median " + format_value(score.error.median, 0.001) +
         " mm, root mean square " + format_value(score.error.rms, 0.001) + " mm";
}

}  // namespace

void draw_differences(const std::filesystem::path& png, const geometry::RangeMapScore& score,
                      const std::string& title) {
  refuse_unless(score.measured > 0, "score", "no pixel was measured: there is nothing to draw");
  const double limit = limit_of(score.error);
  FalseColorPicture picture;
  picture.colors = {-limit, limit, ColorMap::diverging, "error (mm)"};
  picture.title = title;
  picture.subtitle = figures_of(score);
  picture.marked = score.wrong_pixels;
  picture.mark = "wrong";
  draw_false_color(png, score.difference, picture);
}

}  // namespace palpate::pictures
