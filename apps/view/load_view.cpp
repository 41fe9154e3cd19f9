// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "acquisition_view.h"
#include "mesh_view.h"
#include "model_view.h"
#include "palpate/core/error.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/trajectory_file.h"
#include "palpate/probing/acquisition_store.h"
#include "range_view.h"
#include "shared/played_model.h"
#include "view_call.h"

namespace palpate::view {
namespace {

namespace fs = std::filesystem;

std::string name_of(const fs::path& path) {
  const fs::path whole = fs::weakly_canonical(path);
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

/// Makes the view once, of what was loaded.
template <typename Scene>
std::function<std::unique_ptr<View>()> later(Scene scene, std::unique_ptr<View> (*make)(Scene)) {
  return [shared = std::make_shared<Scene>(std::move(scene)), make] {
    return make(std::move(*shared));
  };
}

/// Plays a session again. \throws InvalidInput if it is that of another model or of a scene.
FeltSession read_session(const ViewCall& call, const haptics::Model& model,
                         std::shared_ptr<const haptics::Playback>& playback) {
  const haptics::LoopRecord record = haptics::read_loop_record(call.replay);
  const apps::SessionModels session = apps::models_of(record.session);
  if (session.fingerprints.size() != 1 ||
      session.fingerprints.front() != apps::print_of_model(call.path)) {
    throw InvalidInput(fmt::format("{}: is not the session of {} alone; it was recorded with {}",
                                   call.replay.string(), call.path.string(), session.words));
  }
  if (session.playback != call.playback)
    playback = apps::made_playback(call.path, model, session.playback);
  return felt_again(playback, record);
}

std::function<std::unique_ptr<View>()> load_model(const ViewCall& call) {
  ModelScene scene{.name = name_of(call.path),
                   .model = apps::playable_model(call.path),
                   .playback = {},
                   .still = call.is_still(),
                   .record = call.session};
  scene.playback = apps::made_playback(call.path, scene.model, call.playback);
  if (!call.trajectory.empty()) {
    haptics::TimedPath path(haptics::read_trajectory_file(call.trajectory));
    scene.played = felt_along(scene.playback, std::move(path));
    scene.played_words = "Trajectory " + call.trajectory.filename().string();
  }
  if (!call.replay.empty()) {
    FeltSession session = read_session(call, scene.model, scene.playback);
    scene.played = std::move(session.ticks);
    scene.played_words = fmt::format(
        "Session {}: {}", call.replay.filename().string(),
        session.replay.different == 0 ? std::string("the same to the bit")
                                      : fmt::format("{} ticks differ", session.replay.different));
  }
  if (!call.session.empty()) scene.session = apps::session_text({call.path}, call.playback);
  return later(std::move(scene), make_model_view);
}

std::function<std::unique_ptr<View>()> load_mesh(const ViewCall& call) {
  MeshScene scene{.name = name_of(call.path),
                  .file = geometry::read_mesh_file(call.path, call.mesh)};
  return later(std::move(scene), make_mesh_view);
}

std::function<std::unique_ptr<View>()> load_range_maps(const ViewCall& call) {
  RangeScene scene{.name = name_of(call.path),
                   .sequence = RangeSequence(call.path, call.compare, call.camera),
                   .layer = call.layer,
                   .as_surface = call.as_surface,
                   .still = call.is_still()};
  if (!scene.sequence.has(call.layer)) {
    throw InvalidInput(fmt::format(
        "--show: {} holds only depths; palpate decode writes deviations with --sigma, and reasons "
        "with --reasons.",
        call.path.string()));
  }
  static_cast<void>(scene.sequence.read(0, call.layer));  // refuses what cannot be read
  if (call.layer == MapLayer::depth && scene.sequence.is_compared())
    static_cast<void>(scene.sequence.read(0, MapLayer::difference));
  return later(std::move(scene), make_range_view);
}

std::function<std::unique_ptr<View>()> load_acquisition(const ViewCall& call) {
  AcquisitionScene scene{.name = name_of(call.path),
                         .acquisition = probing::read_acquisition(call.path),
                         .surface = {},
                         .model = {}};
  if (!call.model.empty()) scene.model = haptics::read_model(call.model);
  if (!call.surface.empty()) scene.surface = geometry::read_mesh(call.surface);
  if (scene.model) {
    const auto& contacts = scene.model->contacts;
    const bool any = std::ranges::any_of(scene.acquisition.contacts(), [&](const auto& probed) {
      return std::ranges::any_of(contacts, [&](const auto& c) { return c.id == probed.id; });
    });
    if (!any) {
      throw InvalidInput(
          fmt::format("--model: {} has none of the contacts of {}; give the model "
                      "that was fitted to it.",
                      call.model.string(), call.path.string()));
    }
  }
  return later(std::move(scene), make_acquisition_view);
}

}  // namespace

std::function<std::unique_ptr<View>()> load_view(const ViewCall& call, PathKind kind) {
  switch (kind) {
    case PathKind::model:
      return load_model(call);
    case PathKind::mesh:
      return load_mesh(call);
    case PathKind::range_maps:
      return load_range_maps(call);
    case PathKind::acquisition:
      break;
  }
  return load_acquisition(call);
}

}  // namespace palpate::view
