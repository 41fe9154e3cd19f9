// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "false_color.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "background.h"
#include "depth_span.h"
#include "palpate/core/quantile.h"

namespace palpate::view {
namespace {

constexpr double kDeviationPart = 0.99;  // of the deviations that the colours span
constexpr double kMedians = 4;           // of the differences that the colours span
constexpr double kLeastSpan = 1e-3;      // [mm]

void put(ColorImage& image, const pictures::Rgb& color) {
  image.bytes.insert(image.bytes.end(), {color[0], color[1], color[2], 255});
}

template <typename Image>
ColorImage empty_image(const Image& from) {
  ColorImage image{static_cast<int>(from.cols()), static_cast<int>(from.rows()), {}};
  image.bytes.reserve(4 * static_cast<std::size_t>(from.size()));
  return image;
}

pictures::Rgb color_of(float value, const ColorSpan& span) {
  const auto whole = static_cast<double>(value);
  return pictures::color_at(
      span.map, std::isfinite(whole) ? (whole - span.low) / (span.high - span.low) : std::nan(""));
}

}  // namespace

std::vector<double> known_values(const geometry::ImageF& image) {
  std::vector<double> known;
  for (const float value : image.reshaped<Eigen::RowMajor>()) {
    if (std::isfinite(value)) known.push_back(static_cast<double>(value));
  }
  return known;
}

ColorSpan span_of_depths(const std::vector<double>& depths) {
  if (depths.empty()) return {};
  std::vector<double> object = depths;
  if (const std::optional<double> background = pictures::background_border(depths))
    std::erase_if(object, [&](double z) { return z >= *background; });
  const pictures::DepthSpan span = pictures::depth_span(std::move(object));
  return {.map = pictures::ColorMap::sequential, .low = span.low, .high = span.high};
}

ColorSpan span_of_deviations(std::vector<double> deviations) {
  if (deviations.empty()) return {};
  return {.map = pictures::ColorMap::sequential,
          .low = 0,
          .high = std::max(kLeastSpan, quantile(deviations, kDeviationPart))};
}

ColorSpan span_of_differences(std::vector<double> differences) {
  double half = kLeastSpan;
  for (double& difference : differences) difference = std::abs(difference);
  if (!differences.empty()) half = std::max(half, kMedians * median(differences));
  return {.map = pictures::ColorMap::diverging, .low = -half, .high = half};
}

ColorImage color_image(const geometry::ImageF& image, const ColorSpan& span) {
  ColorImage colors = empty_image(image);
  for (const float value : image.reshaped<Eigen::RowMajor>()) put(colors, color_of(value, span));
  return colors;
}

ColorImage color_image(const geometry::ImageF& image, const ColorSpan& span,
                       const geometry::PixelMask& marked) {
  ColorImage colors = empty_image(image);
  for (Eigen::Index row = 0; row < image.rows(); ++row) {
    for (Eigen::Index col = 0; col < image.cols(); ++col)
      put(colors, marked(row, col) ? pictures::kBlack : color_of(image(row, col), span));
  }
  return colors;
}

ColorImage color_image(const sensing::ReasonImage& reasons) {
  ColorImage colors = empty_image(reasons);
  for (const std::uint8_t reason : reasons.reshaped<Eigen::RowMajor>())
    put(colors,
        pictures::kLabelColors[std::min<std::size_t>(reason, pictures::kLabelColors.size() - 1)]);
  return colors;
}

}  // namespace palpate::view
