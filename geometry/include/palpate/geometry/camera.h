// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// A pinhole camera (or projector) with the lens distortion of Brown and Conrady, as in OpenCV:
///
///     x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///          + 2 p1 x y + p2 (r^2 + 2 x^2)                  u = fx x' + cx
///     y' = y (the same factor) + p1 (r^2 + 2 y^2) + 2 p2 x y    v = fy y' + cy
///
/// Frame: X right, Y down, Z out of the lens. Pixel centres are at whole numbers, (0, 0) top left.
struct Camera {
  int width = 0;   ///< px
  int height = 0;  ///< px
  double fx = 0;   ///< px, > 0
  double fy = 0;   ///< px, > 0
  double cx = 0;   ///< px
  double cy = 0;   ///< px
  /// k1 k2 p1 p2 k3 k4 k5 k6, zero where absent.
  std::array<double, 8> distortion{};

  [[nodiscard]] bool operator==(const Camera&) const = default;
};

/// Checks a camera.
/// \throws InvalidInput naming `what` unless fx, fy and the size are > 0 (size <= 2^28 px) and all
/// values are finite.
void check_camera(const Camera& camera, const char* what);

/// Maps normalised image coordinates (x / z, y / z) to the pixel where the lens shows them. Outside
/// the image the model may fold back: see `undistort`.
[[nodiscard]] Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& normalized);

/// Maps a pixel to normalised image coordinates: the inverse of `distort`, by Newton's method to
/// rounding. NaN where the lens model cannot be inverted: no direction maps to the pixel, or only
/// one beyond a fold.
[[nodiscard]] Eigen::Vector2d undistort(const Camera& camera, const Eigen::Vector2d& pixel);

/// Applies `undistort` to every pixel centre: 2 x (width * height), row by row.
/// \throws InvalidInput if the camera is not valid.
[[nodiscard]] Eigen::Matrix2Xd pixel_rays(const Camera& camera);

}  // namespace palpate::geometry
