// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/geometry/range_map_score.h"

namespace palpate::pictures {

/// Draws the errors of a range map in false colour as a PNG of 1200 x 900 px: blue is negative,
/// white is zero, red is positive, wrong depths are black, unknown ones light grey. The colours
/// span four times the median error to each side; values outside get the colour of the nearest end,
/// and the scale says so. The subtitle gives the coverage, the share of wrong depths and the errors
/// of `score`. The view fits the measured pixels. Works without a display.
/// \throws InvalidInput if no pixel was measured.
/// \throws OutputError if the picture cannot be written.
void draw_differences(const std::filesystem::path& png, const geometry::RangeMapScore& score,
                      const std::string& title);

}  // namespace palpate::pictures
