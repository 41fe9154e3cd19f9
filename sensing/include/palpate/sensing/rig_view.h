// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::sensing {

/// One pose of a flat calibration board in front of the rig: points of its print and their pixels
/// in the camera, and points that the projector lights on it and their pixels in the camera.
struct RigView {
  std::string name;               ///< used in messages and results
  Eigen::Matrix2Xd board{};       ///< 2 x N [mm], the printed points in the plane z = 0
  Eigen::Matrix2Xd camera{};      ///< 2 x N [px], these points in the camera's image
  Eigen::Matrix2Xd lit_camera{};  ///< 2 x M [px], pixels of the camera that see the board, ...
  Eigen::Matrix2Xd
      projector{};  ///< 2 x M [px], ... and the points of the panel that light it there
};

}  // namespace palpate::sensing
