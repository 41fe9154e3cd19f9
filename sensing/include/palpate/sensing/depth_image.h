// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/geometry/range_map.h"

namespace palpate::sensing {

/// Reads the depth image of another depth camera: 16 bit, one channel, with `mm_per_unit` mm per
/// unit. 0 means unknown and becomes NaN in the range map.
/// \throws FileError if the file is damaged, has another type, or does not have the camera's size.
/// \throws InvalidInput unless `mm_per_unit` is finite and > 0 and the camera is valid.
[[nodiscard]] geometry::RangeMap read_depth_image(const std::filesystem::path& path,
                                                  double mm_per_unit,
                                                  const geometry::Camera& camera);

}  // namespace palpate::sensing
