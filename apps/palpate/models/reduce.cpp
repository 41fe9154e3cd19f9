// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "palpate/haptics/model_io.h"
#include "palpate/haptics/scene_requirement.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "shared/scene_needs.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

struct ReduceCall {
  fs::path model, output;
  SceneChoice scene;
  haptics::ReduceOptions options;
};

// Returns the options with the requirements of the scene.
haptics::ReduceOptions required(const ReduceCall& call, const haptics::Model& model) {
  const auto& [scene, object] = call.scene;
  if (scene.empty()) return call.options;
  const haptics::SceneRequirement of = haptics::read_scene_requirement(scene, call.model, object);
  warn_of_tool_radius(of, model);
  haptics::ReduceOptions options = of.options;
  options.strokes = call.options.strokes;
  options.seed = call.options.seed;
  options.reachable = reachable_vertices_of(scene, of, model.surface);
  return options;
}

Json figures_of(const haptics::ReducedModel& reduced, std::size_t contacts) {
  return {{"contacts", reduced.model.contacts.size()},
          {"contacts_before", contacts},
          {"out_of_reach", reduced.out_of_reach},
          {"predicted", reduced.predicted},
          {"simpler_fields", reduced.simpler_fields},
          {"vertices", reduced.model.surface.vertices.cols()},
          {"surface_distance", reduced.surface_distance},
          {"difference",
           {{"rms", reduced.difference.rms},
            {"p90", reduced.difference.p90},
            {"max", reduced.difference.max},
            {"of_contacts", reduced.rms_of_contacts},
            {"of_contacts_and_surface", reduced.rms_of_contacts_and_surface}}},
          {"force_rms", reduced.force_rms},
          {"allowed", reduced.allowed},
          {"raised", reduced.raised},
          {"stated_before", number_or_null(reduced.stated_before)},
          {"stated_after", number_or_null(reduced.stated_after)},
          {"bytes", std::llround(reduced.size_after)},
          {"bytes_before", std::llround(reduced.size_before)}};
}

std::string reduction_in_words(const haptics::ReducedModel& reduced, std::size_t contacts) {
  std::string stated;
  if (reduced.stated_before && reduced.stated_after) {
    stated = fmt::format("\nThe model stated an error of {} there; the reduced one states {}.",
                         newtons(*reduced.stated_before, 3), newtons(*reduced.stated_after, 3));
  }
  return fmt::format(
      "{} of {} contacts remain; out of reach: {}, predicted by the others: {}. Fields with fewer "
      "bases: {}. The surface has {} vertices, and is at most {:.3g} mm away from the old one.\n"
      "{:.0f} kB instead of {:.0f} kB.\n"
      "The forces differ from those of the full model by {} (RMS; 90 % within {}, at most {}); {} "
      "was allowed. The RMS force is {}.{}",
      reduced.model.contacts.size(), contacts, reduced.out_of_reach.size(),
      reduced.predicted.size(), reduced.simpler_fields, reduced.model.surface.vertices.cols(),
      reduced.surface_distance, reduced.size_after / 1e3, reduced.size_before / 1e3,
      newtons(reduced.difference.rms, 3), newtons(reduced.difference.p90, 3),
      newtons(reduced.difference.max, 2), newtons(reduced.allowed, 3),
      newtons(reduced.force_rms, 2), stated);
}

// Warns why a larger error is allowed than was requested.
void tell_raised(const haptics::ReducedModel& reduced) {
  if (!(reduced.raised > 1)) return;
  std::string why;
  if (reduced.difference.rms > reduced.allowed)
    why = "forces differ more even with all contacts in reach";
  else if (reduced.raised_for_size > 1)
    why = "the model would be larger than allowed";
  else
    why = fmt::format("the model itself states an error of {}", newtons(*reduced.stated_before, 3));
  spdlog::warn("{}: the allowed error of the force was raised by a factor of {:.2f}.", why,
               reduced.raised);
}

void reduce(const Settings& settings, const ReduceCall& call) {
  check_model_output({call.model, call.scene.scene}, call.output);
  const haptics::Model model = haptics::read_model(call.model);
  haptics::ReduceOptions options = required(call, model);
  if (const int unknown = haptics::unknown_friction_count(model); unknown > 0) {
    spdlog::warn(
        "the friction of {} contacts is unknown; drags are compared without friction there.",
        unknown);
  }
  options.progress = shown_as("Reducing");
  const haptics::ReducedModel reduced = haptics::reduce_model(model, options);
  haptics::write_model(call.output, reduced.model);
  tell_raised(reduced);
  Json figures = figures_of(reduced, model.contacts.size());
  figures["file"] = call.output.string();
  print(settings, figures,
        fmt::format("{}\nWritten to {}", reduction_in_words(reduced, model.contacts.size()),
                    call.output.string()));
}

}  // namespace

void add_reduce(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ReduceCall>();
  CLI::App* command =
      app.add_subcommand("reduce", "Make a smaller model that holds only what a scene requires");
  add_required(*command, "MODEL", call->model, "Model folder");
  add_required(*command, "-o,--output", call->output, "Model folder to write");
  CLI::Option* scene = add_scene_options(
      *command, call->scene, "the one that has this model",
      "Scene file (YAML or JSON) that says under 'require' what is needed of the model, and where "
      "the tool can be");
  for (CLI::Option* option : add_fields(*command, fields_of(call->options)))
    if (option->get_group() != kExpertOptions) option->excludes(scene);
  command->footer(
      "The smaller model has no contacts that are out of reach or that the others predict, fields "
      "with fewer bases, and a surface with fewer triangles. Random presses and drags are played "
      "with both models to measure how much the forces differ.\n"
      "Examples:\n  palpate reduce model/ --max-error 0.2 -o small/\n"
      "  palpate reduce model/ --max-size 200000 -o small/\n"
      "  palpate reduce model/ --scene scene.yaml -o small/");
  command->callback([call, &settings] { reduce(settings, *call); });
}

}  // namespace palpate::apps
