// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/probe_reach.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstddef>
#include <optional>
#include <string>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::apps {
namespace {

/// Contacts that an arm cannot probe, by reason: "2 too_far (contacts 5, 9)".
std::string out_of_reach(const probing::ContactPlan& plan, const probing::PlanReach& reach) {
  std::string text;
  for (std::size_t reason = 1; reason < probing::kReaches; ++reason) {
    if (reach.counts[reason] == 0) continue;
    std::string ids;
    for (std::size_t i = 0; i < plan.contacts.size(); ++i) {
      if (reach.contacts[i] == static_cast<probing::Reach>(reason))
        ids += fmt::format("{}{}", ids.empty() ? "" : ", ", plan.contacts[i].id);
    }
    text += fmt::format("{}{} {} (contacts {})", text.empty() ? "" : ", ", reach.counts[reason],
                        probing::to_string(static_cast<probing::Reach>(reason)), ids);
  }
  return text;
}

/// The surface of a real object, if it is given.
/// \throws InvalidInput if the plan is of another one.
std::optional<geometry::TriangleMesh> planned_surface(const probing::ContactPlan& plan,
                                                      const fs::path& plan_path,
                                                      const fs::path& surface_path) {
  if (surface_path.empty()) return std::nullopt;
  geometry::TriangleMesh surface = geometry::read_mesh(surface_path);
  if (probing::surface_fingerprint(surface) != plan.surface) {
    throw InvalidInput(
        fmt::format("{}: the plan {} is of another surface; give the one it was made of, or plan "
                    "again",
                    surface_path.string(), plan_path.string()));
  }
  return surface;
}

}  // namespace

probing::PlanReach reach_of_arm(const CampaignArm& arm, const probing::ContactPlan& plan,
                                const fs::path& plan_path, const fs::path& surface_path) {
  const std::optional<geometry::TriangleMesh> surface =
      planned_surface(plan, plan_path, surface_path);
  if (arm.is_device() && !surface) {
    spdlog::warn(
        "Whether the links of the arm stay away from the object is not checked: give --surface.");
  }
  return arm.reach(plan, surface ? &*surface : nullptr);
}

void check_reach(const CampaignArm& arm, const probing::ContactPlan& plan,
                 const fs::path& plan_path, const fs::path& surface_path) {
  const probing::PlanReach reach = reach_of_arm(arm, plan, plan_path, surface_path);
  if (reach.counts[0] == static_cast<int>(plan.contacts.size())) return;
  throw InvalidInput(fmt::format(
      "{}: the arm cannot probe {} of {} contacts: {}. Take them out of the plan, or place the arm "
      "otherwise ('pose' in --arm-config)",
      plan_path.string(), static_cast<int>(plan.contacts.size()) - reach.counts[0],
      plan.contacts.size(), out_of_reach(plan, reach)));
}

}  // namespace palpate::apps
