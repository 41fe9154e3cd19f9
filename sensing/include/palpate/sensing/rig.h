// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// How the red or the blue light path differs from the green one (thesis 3.4.2).
///
/// A scene direction that green shows at the normalised camera coordinate y appears in this channel
/// at y / alpha. A point of this channel's projector panel at the normalised coordinate y_panel is
/// sent out in the direction beta * y_panel + gamma. No difference: 1, 1, 0.
struct ChromaticShift {
  double alpha = 1;  ///< > 0
  double beta = 1;   ///< > 0
  double gamma =
      0;  ///< in normalised direction (tangent of the angle) along the pattern's sinusoid
};

/// A camera and a projector, both calibrated, and where they stand.
struct Rig {
  geometry::Camera camera;
  geometry::Camera projector;
  /// Maps camera coordinates to projector coordinates: x_projector = R x_camera + t [mm].
  Eigen::Isometry3d T_projector_camera = Eigen::Isometry3d::Identity();
  ChromaticShift red;   ///< relative to green
  ChromaticShift blue;  ///< relative to green
};

/// \throws InvalidInput, beginning with `what`, unless both cameras are valid, the pose is a
/// rotation and a translation other than zero, and the chromatic shifts are finite with alpha, beta
/// > 0.
void check_rig(const Rig& rig, const std::string& what);

/// Reads a rig (OpenCV FileStorage: `camera_size`, `camera_matrix`, `camera_distortion`, the same
/// for `projector`, `R`, `t`, and optionally `chromatic`). A distortion has 0, 4, 5 or 8
/// coefficients.
/// \throws FileError naming the file and the key if something is missing, of the wrong shape, not
/// finite, or R is not a rotation.
[[nodiscard]] Rig read_rig(const std::filesystem::path& path);

/// Writes a rig as `read_rig` reads it; every number survives exactly.
/// \throws InvalidInput if the rig is not valid; OutputError.
void write_rig(const std::filesystem::path& path, const Rig& rig);

}  // namespace palpate::sensing
