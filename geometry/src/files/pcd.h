// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {

/// Reads all fields of a PCD file (text, binary or compressed) except padding; unknown points stay
/// NaN. Coordinates are in the unit of the file, and all comments are kept. PCL's reader is not
/// used because its library depends on VTK.
/// \throws FileError if the file is missing, not valid, or truncated (saying how much is there).
[[nodiscard]] PointCloud read_pcd(const std::filesystem::path& path);

/// Writes text or little-endian binary.
/// \throws InvalidInput naming `what` if an attribute has the name of a coordinate, or consists of
/// lists of different lengths.
void write_pcd(std::ostream& stream, const PointCloud& cloud, const WriteOptions& options,
               const char* what);

}  // namespace palpate::geometry
