// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "color_scale.h"
#include "palpate/geometry/range_map_score.h"

namespace palpate::pictures {

struct FalseColorPicture {
  FalseColor colors;  ///< `any_below` and `any_above` are found out
  std::string title;
  std::string subtitle;
  geometry::PixelMask marked{};  ///< pixels to draw in black, whatever their value; empty: none
  std::string mark{};            ///< the meaning of black
  geometry::PixelMask object{};  ///< pixels that the view fits; empty: all known or marked ones
};

/// Draws the part of an image that contains its object, in false colour with a scale, row 0 at the
/// top; non-finite values are grey. If it is not the whole image, the subtitle says which part.
/// \throws OutputError if the picture cannot be written.
void draw_false_color(const std::filesystem::path& png, const geometry::ImageF& image,
                      const FalseColorPicture& picture);

}  // namespace palpate::pictures
