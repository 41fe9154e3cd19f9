// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_reach.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "palpate/require.h"

namespace palpate::probing {
namespace {

/// All forces [N] of a plan at a contact, world frame: each level alone, and with the largest
/// tangential force in each direction.
std::vector<Eigen::Vector3d> planned_forces(const Contact& contact, const ContactPlan& plan) {
  const Eigen::Matrix3d frame = tangent_frame(contact);
  std::vector<Eigen::Vector3d> forces;
  for (std::size_t level = 0; level < plan.normal_forces.size(); ++level) {
    const double normal = plan.normal_forces[level];
    const double most = plan.options.max_force;
    const double tangential = std::sqrt(std::max(most * most - normal * normal, 0.0));
    forces.emplace_back(normal * frame.col(2));
    for (int k = 0; k < plan.options.directions; ++k) {
      const double angle = direction_angle(plan.options, static_cast<int>(level), k);
      forces.emplace_back(frame * Eigen::Vector3d(tangential * std::cos(angle),
                                                  tangential * std::sin(angle), normal));
    }
  }
  return forces;
}

void check_reach_options(const ReachOptions& o) {
  require("ReachOptions::highest_torque", o.highest_torque, above(0).finite(), "N mm");
  require("ReachOptions::share", o.share, above(0).at_most(1));
  require("ReachOptions::clearance", o.clearance, at_least(0).finite(), "mm");
  require("ReachOptions::depth", o.depth, at_least(0).finite(), "mm");
  require("ReachOptions::margin", o.margin, at_least(0).finite(), "mm");
}

}  // namespace

const char* to_string(Reach reach) {
  switch (reach) {
    case Reach::reachable:
      return "reachable";
    case Reach::too_far:
      return "too_far";
    case Reach::too_near:
      return "too_near";
    case Reach::joint_limit:
      return "joint_limit";
    case Reach::too_weak:
      return "too_weak";
  }
  return "";
}

Reach reach_of(const Eigen::Vector3d& p_world, const ReachOptions& options) {
  const Eigen::Vector3d tip = options.T_world_base.inverse() * p_world;
  const double upper = options.geometry.upper, lower = options.geometry.lower;
  if (!(tip.norm() <= upper + lower - options.margin)) return Reach::too_far;
  if (tip.norm() < std::abs(upper - lower) + options.margin ||
      std::hypot(tip.x(), tip.z()) < options.margin)
    return Reach::too_near;
  const std::optional<Eigen::Vector3d> joints = joints_at(options.geometry, tip);
  if (!joints) return Reach::too_near;
  const bool inside = (joints->array() >= options.lowest_joints.array()).all() &&
                      (joints->array() <= options.highest_joints.array()).all();
  return inside ? Reach::reachable : Reach::joint_limit;
}

Reach reach_of(const Contact& contact, const ContactPlan& plan, const ReachOptions& options) {
  constexpr double kStep = 5;  // [mm]
  const double way = options.clearance + options.depth;
  const int steps = std::max(1, static_cast<int>(std::ceil(way / kStep)));
  const std::vector<Eigen::Vector3d> forces = planned_forces(contact, plan);
  for (int i = 0; i <= steps; ++i) {
    const double height = options.clearance - way * i / steps;
    const Eigen::Vector3d place = contact.position + height * contact.normal;
    if (const Reach reach = reach_of(place, options); reach != Reach::reachable) return reach;
    if (height > 0) continue;
    const Eigen::Vector3d joints =
        *joints_at(options.geometry, options.T_world_base.inverse() * place);
    const Eigen::Matrix3d torques = arm_jacobian(options.geometry, joints).transpose() *
                                    options.T_world_base.linear().transpose();
    for (const Eigen::Vector3d& force : forces) {
      if (!((torques * force).cwiseAbs().maxCoeff() <= options.share * options.highest_torque))
        return Reach::too_weak;
    }
  }
  return Reach::reachable;
}

PlanReach reach_of_plan(const ContactPlan& plan, const ReachOptions& options) {
  check_reach_options(options);
  PlanReach result;
  for (const Contact& contact : plan.contacts) {
    result.contacts.push_back(reach_of(contact, plan, options));
    ++result.counts[static_cast<std::size_t>(result.contacts.back())];
  }
  return result;
}

}  // namespace palpate::probing
