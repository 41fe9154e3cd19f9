// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canvas.h"
#include "color_map.h"

namespace palpate::pictures {

struct FalseColor {
  double low = 0;   ///< value of the map's first colour; smaller values get the same colour
  double high = 0;  ///< value of the last colour; > low
  ColorMap map = ColorMap::sequential;
  std::string scale;       ///< label of the scale: quantity and unit
  bool any_below = false;  ///< true if there are values below `low`; the scale then says "< low"
  bool any_above = false;  ///< true if there are values above `high`; the scale then says "> high"
};

/// Width of a colour bar, and the gap between it and its numbers, px.
inline constexpr double kScaleWidth = 26;
inline constexpr double kScaleNumberGap = 11;

/// Draws the colour bar with its numbers and label to the right, and "<" and ">" at its ends if
/// there are values beyond them; `box` is the bar with these marks.
void add_color_scale(Canvas& canvas, const Box& box, const FalseColor& options);

}  // namespace palpate::pictures
