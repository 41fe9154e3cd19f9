// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "palpate/eigen_alignment.h"

namespace palpate::sensing {

/// One pose of a flat calibration board in front of the rig: points in the board's plane, and where
/// the camera and the projector have them.
struct RigView {
  std::string name;              ///< used in messages and results
  Eigen::Matrix2Xd board{};      ///< 2 x N [mm], the printed points in the plane z = 0
  Eigen::Matrix2Xd camera{};     ///< 2 x N [px], where the camera sees these points
  Eigen::Matrix2Xd projector{};  ///< 2 x M [px], points of the projector's panel
  /// 2 x M: where the `projector` points appear. Gray code gives points on the board [mm], ...
  Eigen::Matrix2Xd lit_board{};
  /// ... a still image projected onto the board gives camera pixels [px]. One of `lit_board` and
  /// `lit_camera` is empty, the same one in all views.
  /// empty, in all views the same one.
  Eigen::Matrix2Xd lit_camera{};
};

}  // namespace palpate::sensing
