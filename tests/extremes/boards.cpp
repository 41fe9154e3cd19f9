// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "boards.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>

#include "palpate/sensing/board_views.h"

namespace palpate::extremes {

using namespace sensing;

Rig rig_of_boards() {
  Rig rig;
  rig.camera = {.width = 640, .height = 480, .fx = 800, .fy = 803, .cx = 325, .cy = 237};
  rig.projector = {.width = 512, .height = 384, .fx = 903, .fy = 899, .cx = 252, .cy = 215};
  rig.T_projector_camera.linear() =
      Eigen::AngleAxisd(0.2, Eigen::Vector3d(0.6, -0.8, 0)).toRotationMatrix();
  rig.T_projector_camera.translation() = Eigen::Vector3d(90, 120, -12);
  return rig;
}

std::vector<RigView> views_of_board(int poses, double tilt) {
  const Rig rig = rig_of_boards();
  constexpr Board kBoard{.columns = 9, .rows = 6, .square = 15};
  const Eigen::Matrix2Xd board = board_corners(kBoard);
  std::vector<RigView> views;
  for (int pose = 0; pose < poses; ++pose) {
    const double way = 2.4 * pose;
    const Eigen::AngleAxisd turn(tilt, Eigen::Vector3d(std::cos(way), std::sin(way), 0));
    RigView view{.name = std::to_string(pose), .board = board};
    view.camera = view.projector = board;
    for (Eigen::Index i = 0; i < board.cols(); ++i) {
      const Eigen::Vector3d flat(board(0, i) - 60, board(1, i) - 37.5, 0);
      const Eigen::Vector3d corner =
          Eigen::Vector3d(5 * pose, -4 * pose, 430 + 25 * pose) + turn * flat;
      view.camera.col(i) = geometry::distort(rig.camera, corner.hnormalized());
      view.projector.col(i) =
          geometry::distort(rig.projector, (rig.T_projector_camera * corner).hnormalized());
    }
    view.lit_camera = view.camera;
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace palpate::extremes
