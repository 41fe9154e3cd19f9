// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/played_model.h"

#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playable.h"
#include "shared/fingerprint.h"
#include "shared/inputs.h"
#include "shared/play_friction.h"

namespace palpate::apps {

haptics::Model playable_model(const fs::path& folder) {
  haptics::Model model = haptics::read_model(folder);
  try {
    haptics::check_playable(model);
  } catch (const InvalidInput& wrong) {
    throw InvalidInput(folder.string() + ": " + wrong.what());
  }
  return model;
}

std::shared_ptr<const haptics::Playback> playback_of(const fs::path& folder,
                                                     const haptics::PlaybackOptions& options) {
  return made_playback(folder, playable_model(folder), options);
}

std::string print_of_model(const fs::path& folder) {
  const fs::path json = folder / "field.json";
  return fingerprint(is_there(json) ? json : folder / "field.cbor") +
         fingerprint(folder / "surface.ply");
}

std::string session_text(const std::vector<fs::path>& models,
                         const haptics::PlaybackOptions& options) {
  Json list = Json::array();
  for (const fs::path& model : models)
    list.push_back({{"path", model.string()}, {"fingerprint", print_of_model(model)}});
  Json text{{"models", list}};
  haptics::PlaybackOptions played = options;
  for (const FieldText& field : texts_of(fields_of(played)))
    text["playback"][field.name] = field.text;
  // A path need not be Unicode.
  return text.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SessionModels models_of(const std::string& session) {
  const auto text = Json::parse(session, nullptr, false);
  SessionModels models;
  models.words = "another program";
  if (!text.is_object()) return models;
  if (text.contains("scene")) models.words = "a scene";
  const auto playback = text.value("playback", Json::object());
  for (const auto& [name, value] : playback.items()) {
    if (value.is_string())
      assign(fields_of(models.playback), name, value.get_ref<const std::string&>());
  }
  const auto list = text.value("models", Json());
  if (!list.is_array()) return models;
  models.words.clear();
  for (const auto& model : list) {
    if (!model.is_object()) continue;
    models.fingerprints.push_back(model.value("fingerprint", ""));
    models.words += (models.words.empty() ? "" : " and ") + model.value("path", "another model");
  }
  return models;
}

}  // namespace palpate::apps
