// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_reach.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "palpate/core/require.h"

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
  require("LinkClearance::distance", o.links.distance, at_least(0).finite(), "mm");
  require("LinkClearance::free_end", o.links.free_end, at_least(0).finite(), "mm");
  require("LinkClearance::approach", o.links.approach, at_least(0).finite(), "mm");
}

/// Returns true if all points from one end to the other are at least `distance` [mm] from the
/// surface. Along a line, the distance from a surface changes by no more than the motion.
bool line_is_clear(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double distance,
                   const geometry::SurfaceQuery& surface) {
  constexpr double kShortestStep = 0.1;  // [mm]; half of it may be missed between two points
  const double length = (to - from).norm();
  const Eigen::Vector3d along = (to - from).normalized();
  for (double way = 0;;) {
    const double room = surface.closest_point(from + way * along).distance - distance;
    if (!(room >= 0)) return false;
    if (way >= length) return true;
    way = std::min(length, way + std::max(room, kShortestStep));
  }
}

/// Along the approach, from its beginning to the touch. Places that the arm does not reach are
/// above those where it must be.
bool approach_is_clear(const Contact& contact, const ReachOptions& options,
                       const geometry::SurfaceQuery& surface) {
  constexpr double kStep = 2;  // [mm]
  const double way = options.links.approach;
  const int steps = std::max(1, static_cast<int>(std::ceil(way / kStep)));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d place = contact.position + (way - way * i / steps) * contact.normal;
    if (reach_of(place, options) == Reach::reachable && !links_are_clear(place, surface, options))
      return false;
  }
  return true;
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
    case Reach::collides:
      return "collides";
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

bool links_are_clear(const Eigen::Vector3d& p_world, const geometry::SurfaceQuery& surface,
                     const ReachOptions& options) {
  const ArmGeometry& arm = options.geometry;
  const Eigen::Vector3d tip = options.T_world_base.inverse() * p_world;
  const std::optional<Eigen::Vector3d> joints = joints_at(arm, tip);
  if (!joints) return false;
  const double radius = arm.upper * std::cos((*joints)[1]);
  const Eigen::Vector3d elbow(radius * std::sin((*joints)[0]), arm.upper * std::sin((*joints)[1]),
                              radius * std::cos((*joints)[0]));
  const double held = std::max(0.0, 1 - options.links.free_end / arm.lower);
  const auto world = [&](const Eigen::Vector3d& place) { return options.T_world_base * place; };
  return line_is_clear(world(elbow), world(elbow + held * (tip - elbow)), options.links.distance,
                       surface) &&
         line_is_clear(world(elbow), world(Eigen::Vector3d::Zero()), options.links.distance,
                       surface);
}

Reach reach_of(const Contact& contact, const ContactPlan& plan, const ReachOptions& options,
               const geometry::SurfaceQuery* surface) {
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
  const bool clear = surface == nullptr || approach_is_clear(contact, options, *surface);
  return clear ? Reach::reachable : Reach::collides;
}

PlanReach reach_of_plan(const ContactPlan& plan, const ReachOptions& options,
                        const geometry::SurfaceQuery* surface) {
  check_reach_options(options);
  PlanReach result;
  for (const Contact& contact : plan.contacts) {
    result.contacts.push_back(reach_of(contact, plan, options, surface));
    ++result.counts[static_cast<std::size_t>(result.contacts.back())];
  }
  return result;
}

}  // namespace palpate::probing
