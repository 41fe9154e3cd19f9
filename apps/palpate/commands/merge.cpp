// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "commands/pose_file.h"
#include "palpate/error.h"
#include "palpate/geometry/register_scans.h"
#include "palpate/haptics/merge_models.h"
#include "palpate/haptics/model_io.h"
#include "palpate/output_file.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/model_pictures.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct MergeCall {
  std::vector<fs::path> models, poses;
  fs::path output, picture;
  bool register_here = false, average = false;
  double search_rotation_deg = 45;
  geometry::RegistrationOptions registration;
  haptics::MergeModelsOptions options;
};

std::vector<haptics::SideModel> read_sides(const MergeCall& call) {
  if (!call.poses.empty() && call.poses.size() != call.models.size()) {
    throw InvalidInput(
        fmt::format("palpate merge: {} poses for {} models; give one for each, in "
                    "the same order, or none.",
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

/// Moves the sides onto the first. A pose that is not accepted is no ground to merge on.
/// \return what that was, of each but the first.
Json register_sides(const MergeCall& call, std::vector<haptics::SideModel>& sides) {
  std::vector<geometry::Scan> scans;
  for (const haptics::SideModel& side : sides)
    scans.push_back({.mesh = side.model.surface, .T_object_scan = side.T_object_model});
  geometry::RegistrationOptions options = call.registration;
  options.search_rotation = call.search_rotation_deg * kDegree;
  const std::vector<geometry::Registration> moves = geometry::register_scans(scans, options);
  Json figures = Json::array();
  for (std::size_t i = 0; i < moves.size(); ++i) {
    haptics::SideModel& side = sides[i + 1];
    if (moves[i].verdict != geometry::RegistrationVerdict::accepted) {
      throw SolverError(fmt::format(
          "{} could not be registered to the models before it: {}: {}. Give the poses with --pose "
          "and leave --register out, or bring the models nearer to their places with --pose and "
          "say "
          "how near they are with --search-rotation and --search-translation.",
          side.name, geometry::to_string(moves[i].verdict), moves[i].reason));
    }
    side.T_object_model = moves[i].T_target_source;
    figures.push_back({{"model", side.name},
                       {"verdict", geometry::to_string(moves[i].verdict)},
                       {"reason", moves[i].reason},
                       {"rms", moves[i].rms},
                       {"overlap", moves[i].overlap}});
    spdlog::info("{} was registered: {}", side.name, moves[i].reason);
  }
  return figures;
}

void merge(const Settings& settings, const MergeCall& call) {
  std::vector<fs::path> inputs = call.models;
  inputs.insert(inputs.end(), call.poses.begin(), call.poses.end());
  check_outputs(inputs, {call.output, call.picture});
  check_output_folder(inputs, call.output);
  check_replaceable(call.output, haptics::model_entries());
  std::vector<haptics::SideModel> sides = read_sides(call);
  Json registered = Json::array();
  if (call.register_here) registered = register_sides(call, sides);
  haptics::MergeModelsOptions options = call.options;
  if (call.average) options.surface = haptics::MergedSurface::averaged;
  const haptics::MergedModel merged = haptics::merge_models(sides, options);
  haptics::write_model(call.output, merged.model);
  if (!call.picture.empty())
    draw_model_contacts(call.picture, merged.model,
                        "Merged contacts, their cells and triangulation");

  for (const long long id : merged.isolated)
    spdlog::warn("contact {} lies in no triangle of contacts: there are too few around it.", id);
  if (merged.components > 1) {
    spdlog::warn(
        "the merged surface is in {} pieces: where an object is in one, its models do not "
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
    prose +=
        fmt::format("  contact {} of {} is left out for contact {} of {}, which fits no worse\n",
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
      prose + fmt::format("{} models became one of {} contacts in {} triangles; {} contacts were "
                          "left out, none is further than {:.3f} mm from the merged surface. "
                          "Written to {}",
                          sides.size(), merged.model.contacts.size(), merged.model.triangles.cols(),
                          merged.left_out.size(), merged.largest_distance, call.output.string()));
}

void add_registration_options(CLI::App& command, const std::shared_ptr<MergeCall>& call) {
  CLI::Option* here = command.add_flag(
      "--register", call->register_here,
      "Move each model rigidly onto those before it first, from its pose; it is an error (exit "
      "status 1) if no pose can be relied on");
  command
      .add_option("--search-rotation", call->search_rotation_deg,
                  "With --register: by how much a model may be turned [degrees]")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str()
      ->needs(here);
  command
      .add_option("--search-translation", call->registration.search_translation,
                  "With --register: how far a model's centroid may be from its place [mm]")
      ->check(not_negative())
      ->needs(here);
  command
      .add_option("--min-overlap", call->registration.min_overlap,
                  "With --register: part of a model's surface that those before it have too")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->needs(here);
}

}  // namespace

void add_merge(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MergeCall>();
  CLI::App* command =
      app.add_subcommand("merge", "Models of several sides of an object become one");
  command->add_option("MODEL", call->models, "Model folders, one a side")->required();
  command->add_option("-o,--output", call->output, "Model folder to write")->required();
  command->add_option(
      "--pose", call->poses,
      "Where a model belongs: a text file of its 4 x 4 matrix (rotation and shift "
      "[mm]), one for each model in their order; unless given, all are in one frame");
  add_registration_options(*command, call);
  command->add_flag("--average", call->average,
                    "One smooth surface through all, instead of the measured ones joined by seams");
  command
      ->add_option("--fill-holes", call->options.fill_holes,
                   "Fill holes of the merged surface that are at most so many mm wide")
      ->check(positive());
  command
      ->add_option("--max-distance", call->options.max_distance,
                   "Refuse a contact that is further from the merged surface [mm]")
      ->check(not_negative())
      ->capture_default_str();
  command
      ->add_option(
          "--same-place", call->options.same_place,
          "Contacts of two models that are at most so far apart are one, the one that fits "
          "better [mm] (default: a quarter of the median distance between neighbours)")
      ->check(not_negative());
  command->add_option("--picture", call->picture,
                      "Draw the merged surface, its contacts and their triangulation (PNG)");
  command->footer(
      "Contacts keep their fields and friction; where ids of models are the same those of the k-th "
      "further model are raised by k times a power of ten.\n"
      "Examples:\n  palpate merge front/ back/ --pose front.txt --pose back.txt -o whole/\n"
      "  palpate merge front/ left/ back/ --register --min-overlap 0.3 -o whole/ --picture "
      "whole.png");
  command->callback([call, &settings] { merge(settings, *call); });
}

}  // namespace palpate::apps
