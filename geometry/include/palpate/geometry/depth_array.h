// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// Writes depths exactly, as an array of numpy (.npy): float32, rows x columns [mm], NaN where
/// unknown.
/// \throws InvalidInput if there are no pixels.
/// \throws OutputError if the file cannot be written.
void write_depth_array(const std::filesystem::path& path, const ImageF& z);

}  // namespace palpate::geometry
