// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "color_scale.h"
#include "palpate/geometry/range_map.h"

namespace palpate::pictures {

/// Draws an image in false colour with its scale, row 0 at the top; non-finite values are grey.
/// \throws OutputError if the picture cannot be written.
void draw_false_color(const std::filesystem::path& png, const geometry::ImageF& image,
                      const FalseColor& options, const std::string& title,
                      const std::string& subtitle);

}  // namespace palpate::pictures
