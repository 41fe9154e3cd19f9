// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/haptics/friction_cone.h"

namespace palpate::haptics {

/// Result of a bisection in one tangential direction at one level of normal force: the boundary
/// lies between two tangential forces, apart from noise.
struct SlipInterval {
  Eigen::Vector3d held = Eigen::Vector3d::Zero();     ///< [N] the largest that held
  Eigen::Vector3d slipped = Eigen::Vector3d::Zero();  ///< [N] the smallest that slipped
  double direction = 0;                               ///< [rad] about the pressing direction
  int level = 0;  ///< of normal force, counted from the smallest
};

/// Groups trials by level and direction, and returns the groups that slipped. A force along the
/// pressing direction alone belongs to all directions of its level; if no tangential force held,
/// that force counts as held, because there was contact.
/// \param pressing unit vector about which directions are measured.
[[nodiscard]] std::vector<SlipInterval> slip_intervals(std::span<const FrictionTrial> trials,
                                                       const Eigen::Vector3d& pressing,
                                                       double force_noise);

/// True if at least half of the directions had more than two tangential forces at one level.
[[nodiscard]] bool are_searches(std::span<const FrictionTrial> trials,
                                const Eigen::Vector3d& pressing, double force_noise);

/// Number of different directions.
[[nodiscard]] int count_directions(std::span<const SlipInterval> intervals);

/// Number of different levels.
[[nodiscard]] int count_levels(std::span<const SlipInterval> intervals);

}  // namespace palpate::haptics
