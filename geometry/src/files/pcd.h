// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {

/// Reads all fields of a PCD file (text, binary or compressed) but padding; unknown points stay
/// NaN. Coordinates are in the unit of the file, and comments are all still there. PCL's own reader
/// is not used as its library brings VTK along.
/// \throws FileError if the file is missing, truncated (saying how much of it is there) or wrong.
[[nodiscard]] PointCloud read_pcd(const std::filesystem::path& path);

/// Writes text, or binary with its least significant byte first.
/// \throws InvalidInput naming `what` if an attribute is called as a coordinate, or is of lists of
/// several sizes.
void write_pcd(std::ostream& stream, const PointCloud& cloud, const WriteOptions& options,
               const char* what);

}  // namespace palpate::geometry
