// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/haptics/merge_models.h"
#include "palpate/haptics/model_io.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/model_pictures.h"
#include "shared/output_checks.h"
#include "shared/scan_registration.h"

namespace palpate::apps {
namespace {

struct MergeCall {
  std::vector<fs::path> models, poses;
  fs::path output, picture;
  ScanRegistration registration;
  haptics::MergeModelsOptions options;
};

std::vector<haptics::SideModel> read_sides(const MergeCall& call) {
  if (!call.poses.empty() && call.poses.size() != call.models.size()) {
    throw InvalidInput(
        fmt::format("palpate merge: {} poses for {} models; pass one for each model, in the same "
                    "order, or none.",
                    call.poses.size(), call.models.size()));
  }
  std::vector<haptics::SideModel> sides;
  for (std::size_t i = 0; i < call.models.size(); ++i) {
    sides.push_back({.model = {}, .name = call.models[i].string()});
    if (!call.poses.empty()) sides.back().T_object_model = read_pose(call.poses[i]);
  }
  for (haptics::SideModel& side : sides) side.model = haptics::read_model(side.name);
  return sides;
}

/// Registers each side to the sides before it.
Json register_sides(const MergeCall& call, std::vector<haptics::SideModel>& sides) {
  std::vector<geometry::Scan> scans;
  std::vector<std::string> names;
  for (const haptics::SideModel& side : sides) {
    scans.push_back({.mesh = side.model.surface, .T_object_scan = side.T_object_model});
    names.push_back(side.name);
  }
  Json figures = register_named_scans(scans, names, "model", call.registration);
  for (std::size_t i = 0; i < sides.size(); ++i) sides[i].T_object_model = scans[i].T_object_scan;
  return figures;
}

void merge(const Settings& settings, const MergeCall& call) {
  std::vector<fs::path> inputs = call.models;
  inputs.insert(inputs.end(), call.poses.begin(), call.poses.end());
  check_outputs(inputs, {call.output, call.picture});
  check_model_output(inputs, call.output);
  std::vector<haptics::SideModel> sides = read_sides(call);
  Json registered = Json::array();
  if (call.registration.wanted) registered = register_sides(call, sides);
  const haptics::MergedModel merged = haptics::merge_models(sides, call.options);
  haptics::write_model(call.output, merged.model);
  if (!call.picture.empty())
    draw_model_contacts(call.picture, merged.model,
                        "Merged contacts, their cells and triangulation");

  for (const long long id : merged.isolated)
    spdlog::warn("contact {} is in no triangle of contacts: there are too few around it.", id);
  if (merged.components > 1) {
    spdlog::warn(
        "the merged surface has {} pieces: if the object has only one, its models do not "
        "overlap; check the poses.",
        merged.components);
  }
  Json left_out = Json::array();
  std::string prose;
  for (const Json& side : registered)
    prose += fmt::format("  {}: {}\n", side["model"].get<std::string>(),
                         side["reason"].get<std::string>());
  for (const haptics::LeftOutContact& out : merged.left_out) {
    const std::string& from = sides[static_cast<std::size_t>(out.contact.side)].name;
    const std::string& kept = sides[static_cast<std::size_t>(out.kept.side)].name;
    left_out.push_back({{"model", from},
                        {"contact", out.contact.id},
                        {"kept", {{"model", kept}, {"contact", out.kept.id}}}});
    prose += fmt::format(
        "  contact {} of {} is omitted in favour of contact {} of {}, which fits no worse\n",
        out.contact.id, from, out.kept.id, kept);
  }
  print(
      settings,
      {{"models", sides.size()},
       {"contacts", merged.model.contacts.size()},
       {"triangles", merged.model.triangles.cols()},
       {"left_out", left_out},
       {"same_place", merged.same_place},
       {"largest_distance", merged.largest_distance},
       {"holes_filled", merged.holes_filled},
       {"components", merged.components},
       {"registered", registered},
       {"file", call.output.string()}},
      prose + fmt::format("{} models were merged into one with {} contacts in {} triangles; {} "
                          "contacts were omitted; contacts are at most {:.3f} mm from the merged "
                          "surface. Written to {}",
                          sides.size(), merged.model.contacts.size(), merged.model.triangles.cols(),
                          merged.left_out.size(), merged.largest_distance, call.output.string()));
}

}  // namespace

void add_merge(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MergeCall>();
  CLI::App* command =
      app.add_subcommand("merge", "Merge models of several sides of an object into one");
  add_required(*command, "MODEL", call->models, "Model folders, one per side");
  add_required(*command, "-o,--output", call->output, "Model folder to write");
  command->add_option(
      "--pose", call->poses,
      "Pose of a model: a text file with its 4 x 4 matrix (rotation and translation "
      "[mm]), one per model in the same order (default: all models are in one frame)");
  add_scan_registration(*command, "model", call->registration);
  add_fields(*command, fields_of(call->options));
  command->add_option("--picture", call->picture,
                      "Draw the merged surface, its contacts and their triangulation (PNG)");
  command->footer(
      "Contacts keep their fields and friction. If models use the same ids, the ids of the second "
      "model are increased by a power of ten, those of the third by twice that power, and so on.\n"
      "Examples:\n  palpate merge front/ back/ --pose front.txt --pose back.txt -o whole/\n"
      "  palpate merge front/ left/ back/ --register --min-overlap 0.3 -o whole/ --picture "
      "whole.png");
  command->callback([call, &settings] { merge(settings, *call); });
}

}  // namespace palpate::apps
