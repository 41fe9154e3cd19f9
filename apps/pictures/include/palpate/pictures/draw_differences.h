// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/geometry/range_map.h"

namespace palpate::pictures {

/// Draws signed differences [mm] in false colour as a PNG of 1200 x 900 px: blue is negative, white
/// is zero, red is positive, unknown (NaN) is light grey. The colours span -limit to limit [mm],
/// limit > 0; values outside get the colour of the nearest end. The subtitle gives the root mean
/// square and the share outside. Works without a display.
/// \throws InvalidInput if the image is empty or has no finite value, or limit <= 0.
/// \throws OutputError if the picture cannot be written.
void draw_differences(const std::filesystem::path& png, const geometry::ImageF& differences,
                      const std::string& title, double limit);

}  // namespace palpate::pictures
