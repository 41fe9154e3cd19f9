// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_deviation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "false_color_image.h"
#include "input_checks.h"
#include "palpate/core/quantile.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

/// Of the values at the upper end that the colours need not tell apart.
constexpr double kUpperTail = 0.01;
/// [mm] the scale extends at least to this value, also where all is zero.
constexpr double kLeastScale = 1e-3;

}  // namespace

void draw_deviation(const std::filesystem::path& png, const geometry::ImageF& sigma,
                    const std::string& title) {
  check_image(sigma, "deviations");
  std::vector<float> known;
  std::copy_if(sigma.data(), sigma.data() + sigma.size(), std::back_inserter(known),
               [](float value) { return std::isfinite(value); });
  const auto middle = static_cast<double>(median(known));
  const auto high = static_cast<double>(quantile(known, 1 - kUpperTail));
  const std::string subtitle =
      "predicted standard deviation of each depth; median " + format_value(middle, 0.0001) + " mm";
  FalseColorPicture picture;
  picture.colors = {0, std::max(high, kLeastScale), ColorMap::sequential, "deviation (mm)"};
  picture.title = title;
  picture.subtitle = subtitle;
  draw_false_color(png, sigma, picture);
}

}  // namespace palpate::pictures
