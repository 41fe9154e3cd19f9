// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/plan_scene.h"
#include "palpate/haptics/scene_requirement.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_store.h"
#include "probing/probe_campaign.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/scene_needs.h"
#include "shared/words.h"
#include "whole/plan_project.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// [mm] The usual radius of a tip: closer contacts tell nothing new.
constexpr double kLeastSpacing = 3;
// With fewer contacts, a model tells less about errors with more of them (docs/plan.md).
constexpr std::size_t kEnoughContacts = 40;

struct PlanSceneCall {
  fs::path scene, output, surface, specimen, acquisition;
  std::optional<std::string> object;
  probing::PlanOptions places{.spacing = kLeastSpacing};
};

/// An object of the scene, and what is known of it.
struct PlannedObject {
  haptics::SceneRequirement requirement;
  haptics::Model model;
  std::vector<probing::Contact> places;
};

/// [s] that a campaign needed for each contact.
double measured_contact_time(const fs::path& acquisition) {
  const probing::CampaignStore store = probing::CampaignStore::look(acquisition);
  const probing::CampaignProgress at = replayed(store, acquisition.string()).progress();
  if (at.contacts_done == 0) {
    throw InvalidInput(acquisition.string() +
                       ": no contact is done; without --acquisition, the usual times are taken");
  }
  return at.seconds / at.contacts_done;
}

/// [s] that a campaign is expected to need for each contact.
double usual_contact_time(const probing::ContactPlan& plan) {
  return probing::Campaign(plan, {}).progress().seconds_left /
         static_cast<double>(plan.contacts.size());
}

std::vector<PlannedObject> objects_of(const PlanSceneCall& call,
                                      const haptics::SceneRequirements& scene) {
  std::vector<PlannedObject> objects;
  for (const haptics::SceneRequirement& requirement : scene.objects) {
    if (call.object && requirement.object != *call.object) continue;
    if (!is_there(requirement.model)) {
      throw InvalidInput(fmt::format(
          "{}: object '{}': there is no model {}. A plan follows from a first model, of this "
          "object or of a similar one: measure about {} contacts and fit them, or use 'palpate "
          "bake' for a simulated object",
          call.scene.string(), requirement.object, requirement.model.string(), kEnoughContacts));
    }
    objects.push_back({requirement, haptics::read_model(requirement.model), {}});
  }
  if (objects.empty()) {
    throw InvalidInput(fmt::format("--object: is {}; {} has no such object with 'require'",
                                   *call.object, call.scene.string()));
  }
  return objects;
}

haptics::ObjectNeeds needs_of(const PlanSceneCall& call, PlannedObject& object) {
  haptics::ObjectNeeds needs{.model = &object.model,
                             .options = object.requirement.options,
                             .places = {},
                             .arm_time = object.requirement.arm_time};
  needs.options.reachable =
      reachable_vertices_of(call.scene, object.requirement, object.model.surface);
  const probing::ContactPlan plan =
      probing::plan_contacts(object.model.surface, call.places, needs.options.reachable);
  object.places = plan.contacts;
  for (const probing::Contact& contact : plan.contacts) needs.places.push_back(contact.position);
  needs.contact_time =
      call.acquisition.empty() ? usual_contact_time(plan) : measured_contact_time(call.acquisition);
  return needs;
}

// [mm] A little less than the smallest distance between the first of some places.
double spacing_of(const std::vector<probing::Contact>& places, int count) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, (places[i].position - places[j].position).norm());
  return 0.99 * least;
}

Json figures_of(const haptics::PlannedContacts& of) {
  return {{"contacts", of.contacts},
          {"error", of.error},
          {"arm_hours", of.arm_time / kSecondsPerHour},
          {"bytes", std::llround(of.size)}};
}

Json figures_of(const haptics::SceneRequirement& requirement, const haptics::ObjectPlan& plan) {
  Json curve = Json::array();
  for (const haptics::PlannedContacts& point : plan.curve) curve.push_back(figures_of(point));
  return {{"object", requirement.object},
          {"model", requirement.model.string()},
          {"asked", number_or_null(plan.asked)},
          {"limit", to_string(plan.limit)},
          {"raised", plan.raised},
          {"of_contacts", plan.of_contacts},
          {"present", figures_of(plan.present)},
          {"planned", figures_of(plan.planned)},
          {"with_one_hour_more", figures_of(plan.with_more)},
          {"curve", curve}};
}

std::string row(const haptics::PlannedContacts& of, const char* note) {
  return fmt::format("  {:>8} {:>10} {:>8.1f} {:>11.0f}{}\n", of.contacts, newtons(of.error, 3),
                     of.arm_time / kSecondsPerHour, of.size / 1e3, note);
}

std::string in_words(const haptics::SceneRequirement& requirement,
                     const haptics::ObjectPlan& plan) {
  std::string words = fmt::format(
      "{} ({}): an error of {} is expected with the present {} contacts; {} of it are the errors "
      "of "
      "the contacts themselves.\n  contacts      error  arm [h]  model [kB]\n",
      requirement.object, requirement.model.string(), newtons(plan.present.error, 3),
      plan.present.contacts, newtons(plan.of_contacts, 3));
  std::vector<haptics::PlannedContacts> points = plan.curve;
  std::erase_if(points, [&](const haptics::PlannedContacts& point) {
    return point.contacts == plan.planned.contacts;
  });
  points.push_back(plan.planned);
  std::ranges::sort(points, {}, &haptics::PlannedContacts::contacts);
  for (const haptics::PlannedContacts& point : points)
    words += row(point, point.contacts == plan.planned.contacts ? "  planned" : "");
  words += fmt::format("Decided by {}.", decided_by(plan));
  if (is_good_enough(plan)) {
    words += " The model is good enough as it is.";
  } else {
    words += fmt::format(" One hour of the arm more: {} with {} contacts.",
                         newtons(plan.with_more.error, 3), plan.with_more.contacts);
  }
  if (const auto& size = requirement.options.max_size; size && plan.planned.size > *size) {
    words += fmt::format(" The model will be larger than {:.0f} kB: reduce it.", *size / 1e3);
  }
  return words + "\n";
}

void tell_raised(const haptics::SceneRequirement& requirement, const haptics::ObjectPlan& plan) {
  if (!(plan.raised > 1)) return;
  spdlog::warn(
      "{}: the allowed error of {} cannot be met; {} is expected, {:.2f} times as much. The limit "
      "is "
      "{}.{}",
      requirement.object, newtons(plan.asked.value_or(0), 3), newtons(plan.planned.error, 3),
      plan.raised, decided_by(plan),
      plan.of_contacts > 0.9 * *plan.asked
          ? " Most of it are the errors of the contacts themselves: more samples at each, or less "
            "noise, would help"
          : "");
}

void plan(const Settings& settings, const PlanSceneCall& call) {
  if (!call.surface.empty() && !call.specimen.empty())
    throw InvalidInput("palpate plan: give either --surface or --specimen");
  check_outputs({call.scene, call.acquisition, call.surface, call.specimen}, {call.output});
  const haptics::SceneRequirements scene = haptics::read_scene_requirements(call.scene);
  std::vector<PlannedObject> objects = objects_of(call, scene);
  if (!call.output.empty() && objects.size() > 1) {
    throw InvalidInput(
        fmt::format("--output: a project is for one object; select one of {} with --object",
                    counted(objects.size(), "object")));
  }
  std::vector<haptics::ObjectNeeds> needs;
  for (PlannedObject& object : objects) {
    needs.push_back(needs_of(call, object));
    if (object.model.contacts.size() < kEnoughContacts) {
      spdlog::warn(
          "{}: has {} contacts; from fewer than {}, the expected errors can be wrong by a factor "
          "of "
          "three",
          object.requirement.model.string(), object.model.contacts.size(), kEnoughContacts);
    }
  }
  const std::vector<haptics::ObjectPlan> plans = haptics::plan_scene(needs, scene.arm_time);
  Json figures{{"objects", Json::array()}};
  std::string words;
  double hours = 0;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const haptics::SceneRequirement& requirement = objects[i].requirement;
    tell_raised(requirement, plans[i]);
    figures["objects"].push_back(figures_of(requirement, plans[i]));
    words += in_words(requirement, plans[i]);
    hours += plans[i].planned.arm_time / kSecondsPerHour;
  }
  if (plans.size() > 1) words += fmt::format("All objects: {:.1f} h of the arm.\n", hours);
  if (!call.output.empty()) {
    const PlannedObject& object = objects.front();
    const std::string text = project_of(
        {.project = call.output,
         .scene = call.scene,
         .surface = call.surface.empty() ? object.requirement.model / "surface.ply" : call.surface,
         .specimen = call.specimen,
         .places = call.places,
         .spacing = spacing_of(object.places, plans.front().planned.contacts)},
        object.requirement, plans.front());
    write_file(call.output, [&](std::ostream& out) { out << text; });
    figures["file"] = call.output.string();
    words += fmt::format("Written to {}\n", call.output.string());
  }
  words.pop_back();
  print(settings, figures, words);
}

}  // namespace

void add_plan(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<PlanSceneCall>();
  CLI::App* command = app.add_subcommand(
      "plan", "Find how many contacts the objects of a scene need, and what they cost");
  command
      ->add_option("SCENE", call->scene,
                   "Scene file (YAML or JSON) whose objects say under 'require' what they need")
      ->required();
  command->add_option("-o,--output", call->output,
                      "Project file to write, with the settings for 'palpate run'");
  command->add_option("--object", call->object, "Plan only the object of this name");
  command->add_option("--surface", call->surface,
                      "Mesh of the undeformed object for the project (default: that of the model)");
  command->add_option("--specimen", call->specimen,
                      "Simulated object that the project probes (JSON; docs/probing.md)");
  command->add_option("--acquisition", call->acquisition,
                      "Store of a campaign that shows how long a contact takes (default: the usual "
                      "times)");
  add_fields(*command, fields_of(call->places));
  command->footer(
      "The models of the scene tell what errors to expect with other contacts: models of these "
      "objects with at least 40 contacts, or of similar ones.\n"
      "Examples:\n  palpate plan scene.yaml\n"
      "  palpate plan scene.yaml --object liver --acquisition acquisition.db -o project.yaml");
  command->callback([call, &settings] { plan(settings, *call); });
}

}  // namespace palpate::apps
