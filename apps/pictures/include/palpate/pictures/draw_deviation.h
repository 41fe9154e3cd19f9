// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/geometry/range_map.h"

namespace palpate::pictures {

/// Draws standard deviations [mm] in false colour as a PNG of 1200 x 900 px: small is dark, large
/// is yellow, unknown (NaN) is light grey. The colours span 0 to what 99 % do not exceed. The
/// subtitle gives the median. Works without a display.
/// \throws InvalidInput if the image is empty or holds no finite value; OutputError.
void draw_deviation(const std::filesystem::path& png, const geometry::ImageF& sigma,
                    const std::string& title);

}  // namespace palpate::pictures
