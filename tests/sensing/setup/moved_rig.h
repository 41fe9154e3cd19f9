// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// A rig whose axes converge, with lens distortion.
inline Rig make_verging_rig() {
  Rig rig;
  rig.camera = {.width = 640, .height = 480, .fx = 801, .fy = 803, .cx = 325.3, .cy = 236.7};
  rig.camera.distortion = {-0.12, 0.08, 0.001, -0.0013};
  rig.projector = {.width = 800, .height = 600, .fx = 903, .fy = 899, .cx = 401.9, .cy = 315.3};
  rig.projector.distortion = {0.05, -0.07, -0.0008, 0.0011};
  rig.T_projector_camera.linear() = (Eigen::AngleAxisd(0.21, Eigen::Vector3d::UnitX()) *
                                     Eigen::AngleAxisd(-0.05, Eigen::Vector3d::UnitY()))
                                        .toRotationMatrix();
  rig.T_projector_camera.translation() = Eigen::Vector3d(20.7, 101.3, -11.9);
  return rig;
}

/// The rig with one parameter changed, in the order of `RigCovariance`.
inline Rig moved_rig(Rig rig, int parameter, double change) {
  const auto move = [&](geometry::Camera& lens, int i) {
    double* const linear[] = {&lens.fx, &lens.fy, &lens.cx, &lens.cy};
    (i < 4 ? *linear[i] : lens.distortion.at(static_cast<std::size_t>(i - 4))) += change;
  };
  if (parameter < 9) {
    move(rig.camera, parameter);
  } else if (parameter < 18) {
    move(rig.projector, parameter - 9);
  } else if (parameter < 21) {
    const Eigen::AngleAxisd turn(change, Eigen::Vector3d::Unit(parameter - 18));
    rig.T_projector_camera.linear() = turn * rig.T_projector_camera.linear();
  } else {
    rig.T_projector_camera.translation()[parameter - 21] += change;
  }
  return rig;
}

}  // namespace palpate::sensing
