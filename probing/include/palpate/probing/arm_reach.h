// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/arm_kinematics.h"
#include "palpate/probing/contact_plan.h"

namespace palpate::probing {

/// The reach of an arm at a contact: reachable, or the reason against it.
enum class Reach {
  reachable,
  too_far,      ///< the links are too short
  too_near,     ///< the links cannot fold so far, or the tip would be at the vertical axis
  joint_limit,  ///< a joint would be outside its range
  too_weak,     ///< a motor cannot give the torque of a planned force
  collides      ///< a link would come too near to the object
};
inline constexpr std::size_t kReaches = 6;
/// "reachable", "too_far", "too_near", "joint_limit", "too_weak", "collides".
[[nodiscard]] const char* to_string(Reach reach);

/// Distances of the links from the object while the tip comes to it. Links are the lines between
/// the joints, and from the last joint to the tip.
struct LinkClearance {
  double distance = 3;   ///< [mm] of each link from the surface, with half of its thickness; >= 0
  double free_end = 10;  ///< [mm] before the tip, where the last link may come nearer; >= 0
  double approach = 30;  ///< [mm] along the normal, on which this must hold; >= 0
};

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
  LinkClearance links = {};
};

/// Checks whether the tip can be at a place, with `margin`, and apply no force.
[[nodiscard]] Reach reach_of(const Eigen::Vector3d& p_world, const ReachOptions& options);

/// Returns true if the links stay away from a surface (world frame) while the tip is at a place,
/// which must be reachable: every point of them, up to 0.05 mm.
[[nodiscard]] bool links_are_clear(const Eigen::Vector3d& p_world,
                                   const geometry::SurfaceQuery& surface,
                                   const ReachOptions& options);

/// The worst of a contact: from `clearance` above it to `depth` behind it, a place each 5 mm, with
/// all planned forces where the tip presses.
/// \param surface of the object at rest, for the links along `LinkClearance::approach`, a place each
/// 2 mm; null: they are not checked.
[[nodiscard]] Reach reach_of(const Contact& contact, const ContactPlan& plan,
                             const ReachOptions& options,
                             const geometry::SurfaceQuery* surface = nullptr);

struct PlanReach {
  std::vector<Reach> contacts = {};       ///< of each contact of the plan
  std::array<int, kReaches> counts = {};  ///< of contacts by `Reach`
};
/// \throws InvalidInput if an option is outside its range.
[[nodiscard]] PlanReach reach_of_plan(const ContactPlan& plan, const ReachOptions& options,
                                      const geometry::SurfaceQuery* surface = nullptr);

}  // namespace palpate::probing
