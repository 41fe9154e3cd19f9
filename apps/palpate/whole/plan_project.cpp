// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/plan_project.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "probing/probe_campaign.h"
#include "shared/field_options.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

// Returns a path as a YAML string in double quotes, in the form of JSON.
std::string in_quotes(const fs::path& path) { return nlohmann::json(path.string()).dump(); }

// Options of `probe plan` that differ from the usual ones, without those that the plan chose.
std::string changed_entries(probing::PlanOptions places) {
  probing::PlanOptions usual;
  places.spacing = usual.spacing;
  places.contacts = usual.contacts;
  const Json now = option_values(fields_of(places)), before = option_values(fields_of(usual));
  std::string lines;
  for (const auto& [option, value] : now.items()) {
    if (value != before.at(option))
      lines += fmt::format("  {}: {}\n", option.substr(2), value.get<std::string>());
  }
  if (places.sensor != usual.sensor) {
    lines += fmt::format("  sensor: [{}, {}, {}]\n", places.sensor.x(), places.sensor.y(),
                         places.sensor.z());
  }
  return lines;
}

}  // namespace

std::string decided_by(const haptics::ObjectPlan& plan) {
  switch (plan.limit) {
    case haptics::PlanLimit::force_error:
      return fmt::format("Decided by the allowed error of {}.", newtons(*plan.asked, 3));
    case haptics::PlanLimit::arm_time:
      return "Limited by the arm time of this object.";
    case haptics::PlanLimit::scene_time:
      return "Limited by the arm time of all objects.";
    case haptics::PlanLimit::places:
      return fmt::format("All {} positions that the tip can probe are used.",
                         plan.planned.contacts);
    case haptics::PlanLimit::none:
      break;
  }
  return "Neither force_error nor arm_time is given: the number of contacts stays the same.";
}

std::string project_of(const ProjectSource& source, const haptics::SceneRequirement& requirement,
                       const haptics::ObjectPlan& plan) {
  const fs::path folder = source.project.parent_path();
  const auto from_here = [&](const fs::path& path) {
    return in_quotes(fs::proximate(path, folder.empty() ? fs::path(".") : folder));
  };
  const std::string object = in_quotes(requirement.object), scene = from_here(source.scene),
                    surface = from_here(source.surface);
  const bool measures = !plan.is_met() && plan.limit != haptics::PlanLimit::none;
  if (!measures && !plan.is_reduced) return {};
  std::string text = fmt::format(
      "# How to measure {}, by palpate plan {}. {}\n"
      "# Do all steps with: palpate run {}\n"
      "output: {}\n",
      object, source.scene.filename().string(), decided_by(plan),
      source.project.filename().string(), in_quotes(source.project.stem().string() + "-results"));
  if (measures) {
    const bool is_simulated = !source.specimen.empty();
    const std::string specimen = fmt::format("  specimen: {}\n", from_here(source.specimen));
    text += "plan:\n" + (is_simulated ? specimen : fmt::format("  surface: {}\n", surface));
    if (requirement.region) {
      text += fmt::format("  scene: {}  # contacts only where the tool can be\n  object: {}\n",
                          scene, object);
    }
    text += fmt::format(
        "  contacts: {}  # expected error {}; with the present {} contacts {}\n"
        "  spacing: {:.4g}  # smallest distance of these contacts [mm]\n{}"
        "probe:  # about {:.2g} h of the arm\n",
        plan.planned.contacts, newtons(plan.planned.error, 3), plan.present.contacts,
        newtons(plan.present.error, 3), source.spacing, changed_entries(source.places),
        plan.planned.arm_time / kSecondsPerHour);
    text += is_simulated ? specimen
                         : "  # Add your arm here: arm: DRIVER and arm-config: FILE "
                           "(docs/probing.md).\n";
    text += fmt::format("fit:\n  surface: {}\nevaluate: {{}}\n", surface);
  }
  if (plan.is_reduced) {
    text += "reduce:  # to what the scene needs\n";
    if (!measures) text += fmt::format("  model: {}\n", from_here(requirement.model));
    text += fmt::format("  scene: {}\n  object: {}\n", scene, object);
  }
  return text;
}

}  // namespace palpate::apps
