// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/plan_scene.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/scene_requirement.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_store.h"
#include "probing/probe.h"
#include "probing/probe_campaign.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"
#include "shared/scene_needs.h"
#include "shared/words.h"
#include "whole/plan_explained.h"
#include "whole/plan_project.h"

namespace palpate::apps {
namespace {

// Smallest spacing of contacts, in radii of the tip: closer ones give no new information.
constexpr double kLeastSpacing = 1;
// Distances in space are rounded down by this factor.
constexpr double kRoundedDown = 0.99;
// An arm takes days for more.
constexpr int kMostContacts = 1000;
// With fewer contacts, a model predicts errors with more contacts less well (docs/plan.md).
constexpr std::size_t kEnoughContacts = 40;
// Share of the surface that is turned away from the sensor, above which there is a warning.
constexpr double kMuchOfTheSurface = 0.1;
// The options of `probe plan` that may be given: the plan chooses the others.
constexpr std::array<std::string_view, 8> kPlaceOptions{
    "tip_radius",    "border", "view_angle", "lowest_force",
    "highest_force", "levels", "directions", "max_force"};

struct PlanSceneCall {
  fs::path scene, output, surface, specimen, acquisition;
  std::optional<std::string> object;
  probing::PlanOptions places;
  PlanExplanation explanation;
};

/// An object of the scene, and its known properties.
struct PlannedObject {
  haptics::SceneRequirement requirement;
  haptics::Model model;
  std::vector<probing::Contact> places;
};

/// [N]
double slip_tolerance_of(const PlannedObject& object) {
  return *haptics::playback_options_for(object.model, object.requirement.playback).tolerance;
}

/// [s] Expected time of a campaign for each contact; from the times of an earlier one, if there is
/// one.
double contact_time(const probing::ContactPlan& plan, const fs::path& acquisition) {
  const probing::CampaignProgress expected = probing::Campaign(plan, {}).progress();
  const auto contacts = static_cast<double>(plan.contacts.size());
  if (acquisition.empty()) return expected.seconds_left / contacts;
  const probing::CampaignStore store = probing::CampaignStore::look(acquisition);
  const probing::Campaign before = replayed(store, acquisition.string());
  const probing::CampaignProgress at = before.progress();
  if (at.contacts_done == 0) {
    throw InvalidInput(
        acquisition.string() +
        ": no contact is complete; without --acquisition, 12 s are assumed for each trial");
  }
  const probing::PlanOptions &was = before.plan().options, &now = plan.options;
  if (was.levels == now.levels && was.directions == now.directions)
    return at.seconds / at.contacts_done;
  return at.seconds / at.trials * expected.trials_left / contacts;
}

std::vector<PlannedObject> objects_of(const PlanSceneCall& call,
                                      const haptics::SceneRequirements& scene) {
  std::vector<PlannedObject> objects;
  for (const haptics::SceneRequirement& requirement : scene.objects) {
    if (!is_there(requirement.model)) {
      throw InvalidInput(fmt::format(
          "{}: object '{}': there is no model {}. A plan needs a first model, of this object or of "
          "a similar one: measure about {} contacts and fit them, or use 'palpate bake' for a "
          "simulated object",
          call.scene.string(), requirement.object, requirement.model.string(), kEnoughContacts));
    }
    objects.push_back({requirement, haptics::read_model(requirement.model), {}});
  }
  return objects;
}

// The object whose project is written.
std::size_t selected_object(const PlanSceneCall& call, const std::vector<PlannedObject>& objects) {
  std::string names;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (call.object == objects[i].requirement.object) return i;
    names += (i > 0 ? ", " : "") + objects[i].requirement.object;
  }
  if (call.object)
    throw InvalidInput(fmt::format("--object: is {}; it must be one of: {}", *call.object, names));
  if (objects.size() > 1) {
    throw InvalidInput("--output: a project is for one object; select it with --object: " + names);
  }
  return 0;
}

haptics::ObjectNeeds needs_of(const PlanSceneCall& call, PlannedObject& object) {
  warn_of_tool_radius(object.requirement, object.model);
  haptics::ObjectNeeds needs{.name = object.requirement.object,
                             .model = &object.model,
                             .options = object.requirement.options,
                             .places = {},
                             .arm_time = object.requirement.arm_time};
  needs.options.reachable =
      reachable_vertices_of(call.scene, object.requirement, object.model.surface);
  probing::PlanOptions options = call.places;
  options.spacing = kLeastSpacing * options.tip_radius;
  options.contacts = kMostContacts;
  const probing::ContactPlan plan =
      probing::plan_contacts(object.model.surface, options, needs.options.reachable);
  const auto oblique = static_cast<std::size_t>(probing::Eligibility::oblique);
  if (!object.requirement.region &&
      static_cast<double>(plan.excluded[oblique]) >
          kMuchOfTheSurface * static_cast<double>(object.model.surface.vertices.cols())) {
    spdlog::warn(
        "{}: {} of {} vertices are turned away from the sensor and cannot be probed, but their "
        "errors are included. Limit the region in the scene file, or set --sensor or --view-angle",
        object.requirement.object, plan.excluded[oblique], object.model.surface.vertices.cols());
  }
  object.places = plan.contacts;
  for (const probing::Contact& contact : plan.contacts) needs.places.push_back(contact.position);
  needs.contact_time = contact_time(plan, call.acquisition);
  return needs;
}

// [mm] Smallest distance between the first of some places, rounded down: a plan with this spacing
// has all of them.
double spacing_of(const std::vector<probing::Contact>& places, int count) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, (places[i].position - places[j].position).norm());
  return kRoundedDown * least;
}

Json figures_of(const haptics::PlannedContacts& of) {
  return {{"contacts", of.contacts},
          {"error", of.error},
          {"arm_hours", of.arm_time / kSecondsPerHour},
          {"bytes", std::llround(of.size)}};
}

Json figures_of(const PlanSceneCall& call, const PlannedObject& object,
                const haptics::ObjectPlan& plan) {
  const haptics::SceneRequirement& requirement = object.requirement;
  Json curve = Json::array();
  for (const haptics::PlannedContacts& point : plan.curve) curve.push_back(figures_of(point));
  Json figures{{"object", requirement.object},
               {"model", requirement.model.string()},
               {"asked", number_or_null(plan.asked)},
               {"allowed", number_or_null(plan.allowed)},
               {"met", plan.is_met()},
               {"limit", to_string(plan.limit)},
               {"raised", plan.raised},
               {"of_contacts", plan.of_contacts},
               {"present", figures_of(plan.present)},
               {"planned", figures_of(plan.planned)},
               {"with_one_hour_more", figures_of(plan.with_more)},
               {"curve", curve}};
  if (call.explanation.is_wanted)
    figures["budget"] =
        budget_figures(plan.budget, call.explanation.surface, slip_tolerance_of(object));
  return figures;
}

std::string row(const haptics::PlannedContacts& of, const char* note) {
  return fmt::format("  {:>8} {:>10} {:>8.1f} {:>11.0f}{}\n", of.contacts, newtons(of.error, 3),
                     of.arm_time / kSecondsPerHour, of.size / 1e3, note);
}

std::string plan_in_words(const haptics::SceneRequirement& requirement,
                          const haptics::ObjectPlan& plan) {
  std::string words = fmt::format(
      "{} ({}): an error of {} is expected with the present {} contacts; the contacts themselves "
      "contribute {}. With newly planned contacts:\n  contacts      error  arm [h]  model [kB]\n",
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
  words += decided_by(plan);
  if (plan.is_reduced && plan.asked) {
    words += fmt::format(" The plan aims at {}; the rest is reserved for reducing the model.",
                         newtons(*plan.allowed, 3));
  }
  if (plan.is_met()) {
    words += " The model meets the requirement already, if it is of this object.";
  } else if (plan.with_more.contacts > plan.planned.contacts) {
    words += fmt::format(" With one more hour of the arm: {} with {} contacts.",
                         newtons(plan.with_more.error, 3), plan.with_more.contacts);
  }
  if (const auto& size = requirement.options.max_size; size && plan.planned.size > *size)
    words += fmt::format(" The model will be larger than {:.3g} kB: reduce it.", *size / 1e3);
  return words + "\n";
}

void tell_raised(const haptics::SceneRequirement& requirement, const haptics::ObjectPlan& plan) {
  if (!(plan.raised > 1)) return;
  const double own = std::pow(plan.of_contacts, 2), all = std::pow(plan.planned.error, 2);
  const char* why = own > all / 2
                        ? " Most of it comes from the contacts themselves: more samples at "
                          "each contact, or less noise, would help."
                        : "";
  spdlog::warn("{}: {} is expected, {:.3g} times the error that is planned for ({}). {}{}",
               requirement.object, newtons(plan.planned.error, 3), plan.raised,
               newtons(*plan.allowed, 3), decided_by(plan), why);
}

void plan(const Settings& settings, const PlanSceneCall& call) {
  if (!call.surface.empty() && !call.specimen.empty())
    throw InvalidInput("palpate plan: give either --surface or --specimen");
  const haptics::SceneRequirements scene = haptics::read_scene_requirements(call.scene);
  std::vector<fs::path> inputs{call.scene, call.acquisition, call.surface, call.specimen};
  for (const haptics::SceneRequirement& requirement : scene.objects)
    inputs.push_back(requirement.model);
  check_outputs(inputs, {call.output});
  std::vector<PlannedObject> objects = objects_of(call, scene);
  const std::size_t selected =
      call.output.empty() && !call.object ? 0 : selected_object(call, objects);
  std::vector<haptics::ObjectNeeds> needs;
  for (PlannedObject& object : objects) {
    needs.push_back(needs_of(call, object));
    if (object.model.contacts.size() < kEnoughContacts) {
      spdlog::warn(
          "{}: the model has {} contacts; with fewer than {}, the expected errors can be wrong by "
          "a factor of four",
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
    figures["objects"].push_back(figures_of(call, objects[i], plans[i]));
    words += plan_in_words(requirement, plans[i]);
    if (call.explanation.is_wanted)
      words += budget_in_words(plans[i], call.explanation.surface, slip_tolerance_of(objects[i]));
    hours += plans[i].planned.arm_time / kSecondsPerHour;
  }
  if (plans.size() > 1) words += fmt::format("All objects: {:.1f} h of the arm.\n", hours);
  if (!call.output.empty()) {
    const PlannedObject& object = objects[selected];
    const std::string text = project_of(
        {.project = call.output,
         .scene = call.scene,
         .surface = call.surface.empty() ? object.requirement.model / "surface.ply" : call.surface,
         .specimen = call.specimen,
         .places = call.places,
         .spacing = spacing_of(object.places, plans[selected].planned.contacts)},
        object.requirement, plans[selected]);
    if (text.empty()) {
      words += "Nothing has to be measured or reduced; no project is written.\n";
    } else {
      write_file(call.output, [&](std::ostream& out) { out << text; });
      figures["file"] = call.output.string();
      words += fmt::format("Written to {}\n", call.output.string());
    }
  }
  words.pop_back();
  print(settings, figures, words);
}

}  // namespace

void add_plan(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<PlanSceneCall>();
  CLI::App* command = app.add_subcommand(
      "plan", "Find how many contacts the objects of a scene need, and what they cost");
  add_required(*command, "SCENE", call->scene,
               "Scene file (YAML or JSON) whose objects say under 'require' what they need");
  command->add_option("-o,--output", call->output,
                      "Project file to write, with the settings for 'palpate run'");
  command->add_option("--object", call->object,
                      "Object whose project is written (default: the only one)");
  command->add_option("--surface", call->surface,
                      "Mesh of the undeformed object for the project (default: that of the model)");
  command->add_option("--specimen", call->specimen,
                      "Simulated object that the project probes (JSON or YAML; docs/probing.md)");
  command->add_option("--acquisition", call->acquisition,
                      "Store of a campaign that shows how long a contact takes (default: 12 s for "
                      "each trial)");
  add_explain_options(*command, call->explanation);
  add_fields(*command, fields_of(call->places), kPlaceOptions);
  add_sensor_option(*command, call->places.sensor);
  command->footer(
      "The models of the scene tell what errors to expect with other contacts: models of these "
      "objects with at least 40 contacts, or of similar ones.\n"
      "Examples:\n  palpate plan scene.yaml\n  palpate plan scene.yaml --explain --depth-offset "
      "0.1\n"
      "  palpate plan scene.yaml --object liver --acquisition acquisition.db -o project.yaml");
  command->callback([call, &settings] { plan(settings, *call); });
}

}  // namespace palpate::apps
