// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/geometry/range_map.h"

namespace palpate::pictures {

/// Draws the depths of a range map in false colour as a PNG of 1200 x 900 px: near is blue, far is
/// yellow, unknown (NaN) is light grey. The colours span the depths without the nearest and the
/// farthest 0.5 %, so that a few wrong pixels do not hide the shape. The view fits the known
/// pixels; if a gap in depth separates an object from its background, view and colours are those of
/// the object. Works without a display.
/// \throws InvalidInput if the map is empty or has no finite depth.
/// \throws OutputError if the picture cannot be written.
void draw_range_map(const std::filesystem::path& png, const geometry::RangeMap& map,
                    const std::string& title);

}  // namespace palpate::pictures
