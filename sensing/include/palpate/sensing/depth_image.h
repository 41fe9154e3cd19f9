// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "palpate/geometry/range_map.h"

namespace palpate::sensing {

/// Reads the depth image of another depth camera: 16 bit, one channel, with `mm_per_unit` mm per
/// unit. 0 means unknown and becomes NaN in the range map.
/// \throws FileError if the file is damaged, has another type, or does not have the camera's size.
/// \throws InvalidInput unless `mm_per_unit` is finite and > 0 and the camera is valid.
[[nodiscard]] geometry::RangeMap read_depth_image(const std::filesystem::path& path,
                                                  double mm_per_unit,
                                                  const geometry::Camera& camera);

/// Writes depths as the image of a depth camera, for Open3D, tools of TUM RGB-D and others: PNG of
/// 16 bit and one channel, 0 where unknown, each depth rounded to whole units.
/// \throws InvalidInput unless `mm_per_unit` is finite and > 0, if there are no pixels, or if a
/// known depth becomes 0 or more than 65535 units; the message has a unit that is long or short
/// enough. \throws OutputError if the file cannot be written.
void write_depth_image(const std::filesystem::path& path, const geometry::ImageF& z,
                       double mm_per_unit);

/// The format of the pixels of a PNG file, according to its header.
struct PngPixels {
  int bits = 0;      ///< of a value
  int channels = 0;  ///< without alpha: 1 (grey) or 3 (colour)
};

/// Reads only the first bytes of a file; none if these are not the header of a PNG.
/// \throws FileError if the file cannot be read.
[[nodiscard]] std::optional<PngPixels> read_png_pixels(const std::filesystem::path& path);

/// Returns true for 16 bit and one channel, which depth images have.
[[nodiscard]] constexpr bool may_be_depths(const PngPixels& pixels) {
  return pixels.bits == 16 && pixels.channels == 1;
}

}  // namespace palpate::sensing
