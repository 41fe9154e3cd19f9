// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>

#include "palpate/geometry/camera.h"

namespace palpate::geometry {

/// Image of rows x cols with row 0 at the top; row-major.
using ImageF = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Depth on the raw pixel grid of a camera.
struct RangeMap {
  ImageF z;       ///< [mm] depth along the optical axis, not along the ray; NaN where unknown
  Camera camera;  ///< has the size of `z`
};

/// Computes the 3D point of each pixel, 3 x (rows * cols), row by row, camera frame [mm]; NaN where
/// the depth or the ray of the pixel is unknown.
/// \throws InvalidInput unless the camera is valid and of the size of `z`.
[[nodiscard]] Eigen::Matrix3Xd back_project(const RangeMap& map);

/// Reads the depths of a range map: TIFF, one float32 channel, mm; strips or tiles, any compression
/// of libtiff, either byte order. Values that are not finite or not positive become NaN.
/// \throws FileError if the file is missing, truncated, or of another type.
[[nodiscard]] ImageF read_depth_tiff(const std::filesystem::path& path);

/// Writes depths exactly, as an uncompressed float32 TIFF. Thread-safe.
/// \throws InvalidInput if there are no pixels.
/// \throws OutputError if the file cannot be written.
void write_depth_tiff(const std::filesystem::path& path, const ImageF& z);

}  // namespace palpate::geometry
