// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/geometry/range_map.h"

namespace palpate::pictures {

/// Draws standard deviations [mm] in false colour as a PNG of 1200 x 900 px: small values are dark,
/// large ones yellow, unknown ones (NaN) light grey. The colours span 0 to the 99 % quantile. The
/// subtitle gives the median. Works without a display.
/// \throws InvalidInput if the image is empty or has no finite value.
/// \throws OutputError if the picture cannot be written.
void draw_deviation(const std::filesystem::path& png, const geometry::ImageF& sigma,
                    const std::string& title);

}  // namespace palpate::pictures
