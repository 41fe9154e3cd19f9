// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "palpate/geometry/cloud_ball.h"
#include "palpate/probing/arm_placement.h"

namespace palpate::probing {

/// A ball that the arm holds, at one pose of the arm.
struct HeldBall {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  ///< [mm] frame of the base
  /// Turns directions of the tip into those of the base.
  std::optional<Eigen::Quaterniond> R_base_tip = {};
  std::optional<geometry::SeenBall> seen = {};  ///< frame of the camera; none: it was not found
};

struct BallPlacement : ArmPlacement {
  /// [mm] From the tip to the centre of the ball, in axes of the tip; zero if it is not known.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  /// [mm] Its standard deviations; none if the ball is assumed to be at the tip, because there are
  /// no orientations or these do not determine the offset.
  std::optional<Eigen::Vector3d> offset_deviation = {};
};

/// The pose of an arm's base from a ball that the arm holds and the camera sees, at several poses:
/// the rigid motion that brings the positions of the ball at the arm onto those that the camera
/// sees, by least squares weighted with `SeenBall::information`. A position whose distance is more
/// than six standard deviations contradicts the others and is left out. With orientations of the
/// tip that differ enough, the offset of the ball's centre from the tip is estimated too.
///
/// The stated deviations come from the distances: an error that all positions share, such as the
/// scale of the rig, is not in them.
/// \throws InvalidInput if a number is not finite, or only some poses have an orientation.
[[nodiscard]] BallPlacement place_by_ball(const std::vector<HeldBall>& balls, double ball_radius);

}  // namespace palpate::probing
