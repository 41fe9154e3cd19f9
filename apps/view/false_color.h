// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "color_map.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/sensing/reason.h"

namespace palpate::view {

/// A colour for each pixel, row by row from the top: red, green, blue, 255.
struct ColorImage {
  int width = 0, height = 0;         ///< [px]
  std::vector<unsigned char> bytes;  ///< 4 a pixel
};

/// The range of values that the colours of an image show.
struct ColorSpan {
  pictures::ColorMap map = pictures::ColorMap::sequential;
  double low = 0, high = 1;  ///< [mm] low < high
};

/// The span of depths [mm], or of those of the object before a background; 0 to 1 if none is known.
[[nodiscard]] ColorSpan span_of_depths(const std::vector<double>& depths);
/// From 0 to the 99 % quantile.
[[nodiscard]] ColorSpan span_of_deviations(std::vector<double> deviations);
/// Four times the median of the lengths, to both sides.
[[nodiscard]] ColorSpan span_of_differences(std::vector<double> differences);

/// Finite values of an image.
[[nodiscard]] std::vector<double> known_values(const geometry::ImageF& image);

/// Values beyond the span get the colours of its ends; those that are not finite
/// `pictures::kUnknownColor`.
[[nodiscard]] ColorImage color_image(const geometry::ImageF& image, const ColorSpan& span);
/// The same, with these pixels in black. \param marked of the image's size
[[nodiscard]] ColorImage color_image(const geometry::ImageF& image, const ColorSpan& span,
                                     const geometry::PixelMask& marked);
/// A colour for each reason: `pictures::kLabelColors`.
[[nodiscard]] ColorImage color_image(const sensing::ReasonImage& reasons);

}  // namespace palpate::view
