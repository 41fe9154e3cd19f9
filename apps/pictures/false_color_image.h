// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "color_map.h"
#include "palpate/geometry/range_map.h"

namespace palpate::pictures {

struct FalseColor {
  double low = 0;   ///< value of the map's first colour; smaller ones have it too
  double high = 0;  ///< value of its last; > low
  ColorMap map = ColorMap::sequential;
  std::string scale;  ///< what the scale says: quantity and unit
};

/// Draws an image in false colour with its scale, row 0 at the top; what is not finite is grey.
/// \throws OutputError.
void draw_false_color(const std::filesystem::path& png, const geometry::ImageF& image,
                      const FalseColor& options, const std::string& title,
                      const std::string& subtitle);

}  // namespace palpate::pictures
