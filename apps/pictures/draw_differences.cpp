// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_differences.h"

#include <cmath>

#include "false_color_image.h"
#include "input_checks.h"
#include "palpate/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

/// Digits of figures after the leading one.
constexpr double kFigureStep = 0.001;

}  // namespace

void draw_differences(const std::filesystem::path& png, const geometry::ImageF& differences,
                      const std::string& title, double limit) {
  check_image(differences, "differences");
  require("draw_differences(): limit", limit, above(0).finite(), "mm");
  double squares = 0;
  double count = 0;
  double beyond = 0;
  for (const float difference : differences.reshaped<Eigen::RowMajor>()) {
    const auto value = static_cast<double>(difference);
    if (std::isfinite(value)) {
      squares += value * value;
      count += 1;
      beyond += std::abs(value) > limit ? 1 : 0;
    }
  }
  const std::string subtitle = "root mean square " +
                               format_value(std::sqrt(squares / count), kFigureStep) + " mm over " +
                               format_value(count, 1) + " pixels, " +
                               format_value(100 * beyond / count, 0.1) + " % beyond the scale";
  draw_false_color(png, differences, {-limit, limit, ColorMap::diverging, "difference (mm)"}, title,
                   subtitle);
}

}  // namespace palpate::pictures
