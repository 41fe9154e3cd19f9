// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/play_session.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "commands/play_device.h"
#include "palpate/error.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playable.h"
#include "shared/fingerprint.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using SessionJson = nlohmann::ordered_json;

/// What tells a model from another one, for sessions.
std::string print_of_model(const fs::path& folder) {
  const fs::path json = folder / "field.json";
  return fingerprint(is_there(json) ? json : folder / "field.cbor") +
         fingerprint(folder / "surface.ply");
}

}  // namespace

std::string session_text(const DeviceCall& call) {
  SessionJson models = SessionJson::array();
  for (const fs::path& model : {call.model, call.exchange}) {
    if (!model.empty()) {
      models.push_back({{"path", model.string()}, {"fingerprint", print_of_model(model)}});
    }
  }
  // A path need not be Unicode.
  return SessionJson{{"models", models}}.dump(-1, ' ', false,
                                              SessionJson::error_handler_t::replace);
}

haptics::Model playable_model(const fs::path& folder) {
  haptics::Model model = haptics::read_model(folder);
  try {
    haptics::check_playable(model);
  } catch (const InvalidInput& wrong) {
    throw InvalidInput(folder.string() + ": " + wrong.what());
  }
  return model;
}

std::shared_ptr<const haptics::Playback> playback_of(const fs::path& folder) {
  return std::make_shared<const haptics::Playback>(playable_model(folder));
}

void play_replay(const Settings& settings, const fs::path& model, const fs::path& exchange,
                 const fs::path& session) {
  const haptics::LoopRecord record = haptics::read_loop_record(session);
  const SessionJson text = SessionJson::parse(record.session, nullptr, false);
  std::vector<fs::path> folders = {model};
  if (!exchange.empty()) folders.push_back(exchange);
  const SessionJson models = text.is_object() ? text.value("models", SessionJson()) : SessionJson();
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const bool known = models.is_array() && i < models.size() && models[i].is_object();
    if (known && models[i].value("fingerprint", "") != print_of_model(folders[i])) {
      throw InvalidInput(fmt::format("{}: is not the model of the session, which was {}",
                                     folders[i].string(), models[i].value("path", "another one")));
    }
  }
  std::vector<std::shared_ptr<const haptics::Playback>> playbacks;
  std::vector<const haptics::Playback*> pointers;
  for (const fs::path& folder : folders) {
    playbacks.push_back(playback_of(folder));
    pointers.push_back(playbacks.back().get());
  }
  const haptics::LoopReplay again = haptics::replay(record, pointers);
  if (again.different > 0) {
    throw Error(
        fmt::format("{}: the replay differs in {} of {} ticks, first in tick {}: another version "
                    "of the program "
                    "computed the session",
                    session.string(), again.different, again.ticks, again.first_different));
  }
  print(settings, {{"replayed", again.ticks}, {"different", again.different}},
        fmt::format("{} ticks replayed; every command and contact is the same to the bit",
                    again.ticks));
}

}  // namespace palpate::apps
