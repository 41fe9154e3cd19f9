// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

namespace palpate::sensing {

/// One pose of a flat board before the rig: points in the plane of the board, and where camera and
/// projector have them.
struct RigView {
  std::string name;              ///< in messages and results
  Eigen::Matrix2Xd board{};      ///< 2 x N [mm], the printed points in the plane z = 0
  Eigen::Matrix2Xd camera{};     ///< 2 x N [px], where the camera sees them
  Eigen::Matrix2Xd projector{};  ///< 2 x M [px], points of the projector's panel
  /// 2 x M: what the points in `projector` light. From Gray code, points of the board [mm] ...
  Eigen::Matrix2Xd lit_board{};
  /// ... or, when a still image is projected onto the board, camera pixels [px]. One of both is
  /// empty, in all views the same one.
  Eigen::Matrix2Xd lit_camera{};
};

}  // namespace palpate::sensing
