// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "view_call.h"

#include <map>
#include <set>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/core/require.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "window.h"

namespace palpate::view {
namespace {

constexpr int kLeastWidth = 2 * Window::kPanelWidth, kLeastHeight = Window::kPanelWidth;  // [px]
constexpr int kMostSide = 8192;                                                           // [px]

/// Options that only one kind knows, and its name.
const std::map<std::string, std::pair<PathKind, const char*>>& options_of_kinds() {
  static const std::map<std::string, std::pair<PathKind, const char*>> options = [] {
    std::map<std::string, std::pair<PathKind, const char*>> all;
    for (const char* name : {"--trajectory", "--session", "--replay"})
      all[name] = {PathKind::model, "a model"};
    haptics::PlaybackOptions playback;
    for (const FieldText& field : texts_of(fields_of(playback)))
      all[apps::option_name(field.name)] = {PathKind::model, "a model"};
    for (const char* name : {"--compare", "--rig", "--scale", "--intrinsics", "--show", "--as"})
      all[name] = {PathKind::range_maps, "range maps"};
    for (const char* name : {"--surface", "--model"})
      all[name] = {PathKind::acquisition, "an acquisition"};
    all["--unit"] = {PathKind::mesh, "a mesh"};
    return all;
  }();
  return options;
}

const char* name_of(PathKind kind) {
  switch (kind) {
    case PathKind::model:
      return "a model";
    case PathKind::mesh:
      return "a mesh";
    case PathKind::range_maps:
      return "range maps";
    case PathKind::acquisition:
      break;
  }
  return "an acquisition";
}

}  // namespace

void add_options(CLI::App& app, ViewCall& call) {
  app.add_option("PATH", call.path,
                 "Model, mesh, folder of range maps or one of them, or acquisition")
      ->required();

  const char* model = "A model";
  app.add_option("--trajectory", call.trajectory,
                 "Positions of the tool over time (CSV with t,x,y,z), instead of the mouse")
      ->group(model);
  app.add_option("--session", call.session,
                 "File to which the movements of the mouse are recorded, for --replay")
      ->group(model);
  app.add_option("--replay", call.replay, "Recorded file of --session to play again")->group(model);
  for (CLI::Option* option : apps::add_fields(app, fields_of(call.playback)))
    if (option->get_group() != apps::kExpertOptions) option->group(model);

  const char* maps = "Range maps";
  app.add_option("--compare", call.compare,
                 "Range maps to compare with: true depths, or another sequence")
      ->group(maps);
  apps::add_choice<MapLayer>(
      app, "--show", call.layer,
      {{"depth", MapLayer::depth},
       {"deviation", MapLayer::deviation},
       {"reason", MapLayer::reason},
       {"difference", MapLayer::difference}},
      "What the window shows when it opens: depth, deviation, reason or difference")
      ->group(maps);
  apps::add_choice<bool>(app, "--as", call.as_surface, {{"image", false}, {"surface", true}},
                         "How the window shows it when it opens: as an image or as a surface")
      ->group(maps);
  apps::add_camera_options(app, call.camera);
  for (const char* name : {"--rig", "--scale", "--intrinsics"}) app.get_option(name)->group(maps);

  const char* acquisition = "An acquisition";
  app.add_option("--surface", call.surface, "Surface of the object, a mesh")->group(acquisition);
  app.add_option("--model", call.model, "Model whose forces are compared with the measured ones")
      ->group(acquisition);

  apps::add_unit_option(app, call.mesh);
  app.get_option("--unit")->group("A mesh");

  const char* pictures = "Pictures";
  app.add_option("--screenshot", call.screenshot, "Write one picture (PNG), and show no window")
      ->group(pictures);
  app.add_option("--movie", call.movie,
                 "Write a movie, 30 pictures per second, to a folder, and show no window")
      ->group(pictures);
  app.add_option("--seconds", call.seconds,
                 "Time that the picture shows, length of the movie, or time after which the window "
                 "closes [s] (default: the end of what is played; a window stays open)")
      ->check(apps::within(at_least(0).finite()))
      ->group(pictures);
  app.add_option("--width", call.width, "Width of picture or window [px] (default: 1280)")
      ->check(apps::within(at_least(kLeastWidth).at_most(kMostSide)))
      ->group(pictures);
  app.add_option("--height", call.height, "Height of picture or window [px] (default: 800)")
      ->check(apps::within(at_least(kLeastHeight).at_most(kMostSide)))
      ->group(pictures);
}

void check_call(const ViewCall& call, PathKind kind, const CLI::App& app) {
  for (const auto& [name, of] : options_of_kinds()) {
    if (app.count(name) == 0 || of.first == kind) continue;
    throw InvalidInput(name + ": is for " + of.second + "; " + call.path.string() + " is " +
                       name_of(kind) + ".");
  }
  apps::check_outputs({call.path, call.trajectory, call.replay, call.compare, call.surface,
                       call.model, call.camera.rig},
                      {call.session, call.screenshot});
  apps::check_pictures({call.screenshot});
  if (!call.movie.empty()) apps::check_output_folder({call.path, call.compare}, call.movie);
  if (!call.screenshot.empty() && !call.movie.empty())
    throw InvalidInput("--movie: excludes --screenshot; write one of them.");
  if (!call.trajectory.empty() && !call.replay.empty())
    throw InvalidInput("--replay: excludes --trajectory; one of them moves the tool.");
  const bool moved_by_file = !call.trajectory.empty() || !call.replay.empty();
  if (!call.session.empty() && moved_by_file) {
    throw InvalidInput(
        "--session: records what the mouse does; without --trajectory and --replay. palpate play "
        "--device trajectory --session records a trajectory.");
  }
  if (!call.session.empty() && call.is_still())
    throw InvalidInput("--session: records what the mouse does; without --screenshot and --movie.");
  if (call.layer == MapLayer::difference && call.compare.empty())
    throw InvalidInput("--show difference: needs --compare, with what the depths are compared.");
}

}  // namespace palpate::view
