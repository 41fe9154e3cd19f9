// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canvas.h"
#include "color_map.h"

namespace palpate::pictures {

struct FalseColor {
  double low = 0;   ///< value of the map's first colour; smaller ones have it too
  double high = 0;  ///< value of its last; > low
  ColorMap map = ColorMap::sequential;
  std::string scale;  ///< what the scale says: quantity and unit
};

/// Draws the bar of colours with its numbers and meaning to its right; `box` is the bar alone.
void add_color_scale(Canvas& canvas, const Box& box, const FalseColor& options);

}  // namespace palpate::pictures
