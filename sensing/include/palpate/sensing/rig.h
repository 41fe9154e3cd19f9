// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// Chromatic aberration of the red or the blue light path, relative to green (thesis 3.4.2).
///
/// Green shows a scene direction at the normalised camera coordinate y; this channel shows it at
/// y / alpha. This channel of the projector sends light from the normalised panel coordinate
/// y_panel into the direction beta * y_panel + gamma. The values 1, 1, 0 mean no aberration.
struct ChromaticShift {
  double alpha = 1;  ///< > 0
  double beta = 1;   ///< > 0
  double gamma =
      0;  ///< offset along the pattern's sinusoid, in normalised coordinates (tangent of the angle)
};

inline constexpr int kRigParameters = 24;
/// Covariance of fx fy cx cy k1 k2 p1 p2 k3 of the camera [px, 1], of the same of the projector, of
/// a small rotation applied after R [rad], and of t [mm]; zero where a parameter is exact.
using RigCovariance = Eigen::Matrix<double, kRigParameters, kRigParameters>;

/// A calibrated camera and projector, and the pose between them.
struct Rig {
  geometry::Camera camera;
  geometry::Camera projector;
  /// Maps camera coordinates to projector coordinates: x_projector = R x_camera + t [mm].
  Eigen::Isometry3d T_projector_camera = Eigen::Isometry3d::Identity();
  ChromaticShift red;   ///< relative to green
  ChromaticShift blue;  ///< relative to green
  /// Light that the camera's red, green and blue channel (rows) receive from the projector's red,
  /// green and blue (columns), relative to the diagonal, which is 1: the camera's colour filters
  /// overlap. The identity means that they do not.
  Eigen::Matrix3d color_mixing = Eigen::Matrix3d::Identity();
  /// Uncertainty of the rig. Empty if it is not known: the rig then counts as exact.
  std::optional<RigCovariance> covariance{};
};

/// Checks that both cameras are valid, that the pose is a rotation and a non-zero translation, that
/// the chromatic shifts are finite with alpha, beta > 0, that the colour mixing has ones on its
/// diagonal and an inverse without entries beyond 10 in size, and that the covariance is finite,
/// symmetric and has no negative variance.
/// \throws InvalidInput otherwise; the message begins with `what`.
void check_rig(const Rig& rig, const std::string& what);

/// Reads a rig from OpenCV FileStorage: `camera_size`, `camera_matrix`, `camera_distortion`, the
/// same three keys for `projector`, `R`, `t`, and optionally `chromatic` with `red`, `blue` and
/// `mixing`, and `covariance`. A lens distortion has 0, 4, 5 or 8 coefficients.
/// \throws FileError naming the file and the key if a value is missing, has the wrong shape or is
/// not finite, or if R is not a rotation.
[[nodiscard]] Rig read_rig(const std::filesystem::path& path);

/// Writes a rig so that `read_rig` reads every number back exactly.
/// \throws InvalidInput if the rig is not valid.
/// \throws OutputError if the file cannot be written.
void write_rig(const std::filesystem::path& path, const Rig& rig);

}  // namespace palpate::sensing
