// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace palpate::geometry {

/// Reads x, y, z of a PCD file (text, binary or compressed), 3 x N; unknown points stay NaN. PCL's
/// own reader is not used as its library brings VTK along.
/// \throws FileError if the file is missing, truncated (saying how much of it is there) or wrong.
[[nodiscard]] Eigen::Matrix3Xd read_pcd(const std::filesystem::path& path);

}  // namespace palpate::geometry
