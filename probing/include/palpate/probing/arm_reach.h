// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "palpate/eigen_alignment.h"
#include "palpate/probing/arm_kinematics.h"
#include "palpate/probing/contact_plan.h"

namespace palpate::probing {

/// Whether an arm can probe a contact, and why not.
enum class Reach {
  reachable,
  too_far,      ///< the links are too short
  too_near,     ///< the links cannot fold so far, or the tip would be at the vertical axis
  joint_limit,  ///< a joint would be outside its range
  too_weak      ///< a motor cannot give the torque of a planned force
};
inline constexpr std::size_t kReaches = 5;
/// "reachable", "too_far", "too_near", "joint_limit", "too_weak".
[[nodiscard]] const char* to_string(Reach reach);

struct ReachOptions {
  ArmGeometry geometry = {};
  Eigen::Isometry3d T_world_base = Eigen::Isometry3d::Identity();
  Eigen::Vector3d lowest_joints{-1.4, -0.9, -1.2};  ///< [rad]
  Eigen::Vector3d highest_joints{1.4, 1.6, 1.2};    ///< [rad]
  double highest_torque = 1445;                     ///< [N mm] of each motor; > 0
  double share = 0.9;     ///< of this torque that planned forces may need; in (0, 1]
  double clearance = 20;  ///< [mm] above the surface; >= 0
  double depth = 10;      ///< [mm] that a tip may go into the object; >= 0
  double margin = 5;      ///< [mm] to the limits of the links; >= 0
};

/// Whether the tip can be at a place, with `margin`, and apply no force.
[[nodiscard]] Reach reach_of(const Eigen::Vector3d& p_world, const ReachOptions& options);

/// The worst of a contact: from `clearance` above it to `depth` behind it, a place each 5 mm, with
/// all planned forces where the tip presses.
[[nodiscard]] Reach reach_of(const Contact& contact, const ContactPlan& plan,
                             const ReachOptions& options);

struct PlanReach {
  std::vector<Reach> contacts = {};       ///< of each contact of the plan
  std::array<int, kReaches> counts = {};  ///< of contacts by `Reach`
};
/// \throws InvalidInput if an option is outside its range.
[[nodiscard]] PlanReach reach_of_plan(const ContactPlan& plan, const ReachOptions& options);

}  // namespace palpate::probing
