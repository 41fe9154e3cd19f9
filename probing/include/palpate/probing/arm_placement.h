// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// One touch, or one position of a ball.
struct PlacementResidual {
  /// [mm] Of a touch: how far the tip is from touching the surface, > 0 outside. Of a ball:
  /// distance between where the camera and the arm say that it is. NaN if it is not known.
  double distance = 0;
  bool used = false;  ///< false: it contradicts the others, is at the border, or is not known
  /// The nearest place of the surface is its border: the tip may have touched what is beyond it.
  bool at_border = false;
};

/// The measurement that would reduce the weakest direction of a pose most.
struct PlacementAdvice {
  Eigen::Vector3d tip_base = Eigen::Vector3d::Zero();    ///< [mm] position of the tip for the arm
  Eigen::Vector3d tip_camera = Eigen::Vector3d::Zero();  ///< [mm] the same for the camera
  std::string direction;  ///< the weakest direction: "a turn about (0.00, 1.00, 0.00)"
  double before = 0;      ///< [mm] standard deviation of a typical position along it
  double after = 0;       ///< [mm] the same with one more measurement
};

/// The pose of the base of an arm in the frame of a camera.
struct ArmPlacement {
  /// Maps coordinates of the base to those of the camera: `pose` of a setup.
  Eigen::Isometry3d T_camera_base = Eigen::Isometry3d::Identity();
  /// True if the pose can be used. Read this first.
  bool determined = false;
  std::string reason;  ///< in a sentence, with figures
  /// [mm] Mean of the used positions of the tip, frame of the camera.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  /// Covariance of the pose, from the residuals. Order: rotation about `centre` [rad] about the
  /// camera's x, y, z, then shift of `centre` [mm] along them.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms = 0;  ///< [mm] of the used distances
  int used = 0;
  std::vector<PlacementResidual> residuals;  ///< one per measurement, in their order
  std::optional<PlacementAdvice> advice;     ///< none if no measurement would help
  std::vector<std::string> doubts;           ///< unlikely features of the measurements

  [[nodiscard]] Eigen::Vector3d turn_deviation() const {  ///< [rad]
    return covariance.diagonal().head<3>().cwiseSqrt();
  }
  [[nodiscard]] Eigen::Vector3d shift_deviation() const {  ///< [mm] of `centre`
    return covariance.diagonal().tail<3>().cwiseSqrt();
  }
};

}  // namespace palpate::probing
