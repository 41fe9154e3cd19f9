// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/play_session.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "models/play_device.h"
#include "models/play_scene.h"
#include "palpate/core/error.h"
#include "palpate/haptics/loop_record.h"
#include "shared/fingerprint.h"
#include "shared/played_model.h"

namespace palpate::apps {
namespace {

std::string text_of(const Json& json) {
  // A path need not be Unicode.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// What a scene's session was of: the path of each file and model, with its fingerprint.
Json prints_of(const SceneOfDevice& scene) {
  Json prints = Json::array();
  for (const fs::path& path : scene.file.sources)
    prints.push_back({{"path", path.string()}, {"fingerprint", fingerprint(path)}});
  for (const fs::path& path : scene.file.models)
    prints.push_back({{"path", path.string()}, {"fingerprint", print_of_model(path)}});
  return prints;
}

void report_replay(const Settings& settings, const fs::path& session,
                   const haptics::LoopReplay& again) {
  if (again.different > 0) {
    throw Error(
        fmt::format("{}: the replay differs in {} of {} ticks, first in tick {}: another version "
                    "of the program computed the session",
                    session.string(), again.different, again.ticks, again.first_different));
  }
  print(settings, {{"replayed", again.ticks}, {"different", again.different}},
        fmt::format("{} ticks replayed; every command and contact is the same to the bit",
                    again.ticks));
}

}  // namespace

std::string session_text(const DeviceCall& call) {
  std::vector<fs::path> models = {call.model};
  if (!call.exchange.empty()) models.push_back(call.exchange);
  return session_text(models, call.playback);
}

SceneOfDevice read_scene_of_device(const fs::path& path, const std::string& tool) {
  SceneOfDevice scene{.file = haptics::read_scene(path), .inputs = {}};
  const std::vector<std::string>& tools = scene.file.tools;
  if (!tool.empty()) {
    const auto found = std::ranges::find(tools, tool);
    if (found == tools.end()) {
      throw InvalidInput(fmt::format("--tool: {} has no tool '{}'; it has {}", path.string(), tool,
                                     fmt::join(tools, ", ")));
    }
    scene.tool = static_cast<std::size_t>(found - tools.begin());
  }
  check_ways(scene.file, scene.tool, path);
  scene.inputs = scene.file.sources;
  scene.inputs.insert(scene.inputs.end(), scene.file.models.begin(), scene.file.models.end());
  return scene;
}

std::string session_text(const SceneOfDevice& scene) {
  return text_of({{"scene", prints_of(scene)}, {"tool", scene.file.tools[scene.tool]}});
}

std::shared_ptr<haptics::SceneWorld> world_of(const SceneOfDevice& scene, double tick) {
  haptics::SceneFile file = scene.file;
  file.options.tick = tick;
  return std::make_shared<haptics::SceneWorld>(
      std::make_shared<const haptics::Scene>(haptics::make_scene(file, playable_model)),
      scene.file.motion, scene.tool);
}

void play_replay(const Settings& settings, const fs::path& model, const fs::path& exchange,
                 const fs::path& session) {
  const haptics::LoopRecord record = haptics::read_loop_record(session);
  const Json text = Json::parse(record.session, nullptr, false);
  if (text.is_object() && text.contains("scene")) {
    throw InvalidInput(fmt::format("{}: is the session of a scene; give its file in place of {}",
                                   session.string(), model.string()));
  }
  std::vector<fs::path> folders = {model};
  if (!exchange.empty()) folders.push_back(exchange);
  const Json models = text.is_object() ? text.value("models", Json()) : Json();
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const bool known = models.is_array() && i < models.size() && models[i].is_object();
    if (known && models[i].value("fingerprint", "") != print_of_model(folders[i])) {
      throw InvalidInput(fmt::format("{}: is not the model of the session, which was {}",
                                     folders[i].string(), models[i].value("path", "another one")));
    }
  }
  const haptics::PlaybackOptions playback = models_of(record.session).playback;
  std::vector<std::shared_ptr<const haptics::Playback>> playbacks;
  std::vector<const haptics::Playback*> pointers;
  for (const fs::path& folder : folders) {
    playbacks.push_back(playback_of(folder, playback));
    pointers.push_back(playbacks.back().get());
  }
  report_replay(settings, session, haptics::replay(record, pointers));
}

void play_scene_replay(const Settings& settings, const fs::path& path, const fs::path& session) {
  const haptics::LoopRecord record = haptics::read_loop_record(session);
  const Json text = Json::parse(record.session, nullptr, false);
  const bool of_scene = text.is_object() && text.contains("scene") && text["scene"].is_array();
  if (!of_scene) {
    throw InvalidInput(fmt::format("{}: is not a session of a scene; give its model in place of {}",
                                   session.string(), path.string()));
  }
  const SceneOfDevice scene = read_scene_of_device(path, text.value("tool", ""));
  const Json then = text["scene"], now = prints_of(scene);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const bool known = i < then.size() && then[i].is_object();
    if (known && then[i].value("fingerprint", "") == now[i].at("fingerprint")) continue;
    throw InvalidInput(fmt::format(
        "{}: is not what it was in the session{}", now[i].at("path").get<std::string>(),
        known ? ", where it was " + then[i].value("path", "another file") : std::string()));
  }
  report_replay(settings, session, haptics::replay(record, *world_of(scene, record.device.period)));
}

}  // namespace palpate::apps
