// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "palpate/probing/ball_placement.h"

namespace palpate::probing {

/// The balls that were found, as columns.
struct BallPoints {
  Eigen::Matrix3Xd tips;                     ///< [mm] frame of the base
  Eigen::Matrix3Xd seen;                     ///< [mm] frame of the camera
  std::vector<Eigen::Matrix3d> turns;        ///< of the tip; identity if not known
  std::vector<Eigen::Matrix3d> information;  ///< of `seen`; of trace 3
  std::vector<double> radii;                 ///< [mm] that fit best
  std::vector<std::size_t> rows;             ///< among all poses
  bool oriented = false;

  [[nodiscard]] Eigen::Index size() const { return tips.cols(); }
};

[[nodiscard]] BallPoints ball_points(const std::vector<HeldBall>& balls);

/// The rigid motion on which most of the positions agree, and the median of their distances.
struct AgreedPose {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  double median = 0;  ///< [mm]
};

/// The best of the rigid motions of three positions each (least median of squares; Rousseeuw 1984):
/// of all, or of some thousand if there are more.
[[nodiscard]] AgreedPose agreed_pose(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

}  // namespace palpate::probing
