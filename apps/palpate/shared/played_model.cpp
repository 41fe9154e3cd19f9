// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/played_model.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playable.h"
#include "shared/inputs.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

void tell_unknown_friction(const fs::path& folder, int unknown, double played) {
  if (unknown == 0) return;
  spdlog::warn("{}: the friction of {} is unknown; it is played with a coefficient of {:g}{}",
               folder.string(), counted(unknown, "contact"), played,
               played == 0 ? ": the tool slides without friction." : ".");
}

}  // namespace

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
  return file_fingerprint(is_there(json) ? json : folder / "field.cbor") +
         file_fingerprint(folder / "surface.ply");
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

void check_friction(const fs::path& folder, int unknown, double played) {
  if (played != haptics::PlaybackOptions{}.unknown_friction && unknown == 0) {
    throw InvalidInput(
        fmt::format("--unknown-friction: is for contacts whose friction is unknown; "
                    "{} knows that of all contacts",
                    folder.string()));
  }
  tell_unknown_friction(folder, unknown, played);
}

std::shared_ptr<const haptics::Playback> made_playback(const fs::path& folder,
                                                       const haptics::Model& model,
                                                       const haptics::PlaybackOptions& options) {
  check_friction(folder, haptics::unknown_friction_count(model), options.unknown_friction);
  return std::make_shared<const haptics::Playback>(model, options);
}

void tell_unknown_friction(const haptics::SceneFile& file, const haptics::Scene& scene) {
  for (std::size_t o = 0; o < file.objects.size(); ++o) {
    tell_unknown_friction(file.models[o], scene.objects()[o].playback->unknown_friction_count(),
                          file.playback[o].unknown_friction);
  }
}

StepTimes time_steps(const haptics::Playback& playback,
                     std::span<const haptics::TrajectoryPoint> trajectory) {
  using Clock = std::chrono::steady_clock;
  std::array<std::vector<double>, 3> by_state;
  std::vector<double> all;
  all.reserve(trajectory.size());
  for (std::vector<double>& times : by_state) times.reserve(trajectory.size());
  haptics::LoopState state;
  double before = trajectory.empty() ? 0 : trajectory.front().time;
  for (const haptics::TrajectoryPoint& point : trajectory) {
    const Clock::time_point start = Clock::now();
    const haptics::Command command = playback.step(point.tool, state, point.time - before);
    before = point.time;
    const double elapsed = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    by_state[static_cast<std::size_t>(command.state)].push_back(elapsed);
    all.push_back(elapsed);
  }
  const auto of = [&](haptics::ContactState s) {
    return geometry::error_statistics(by_state[static_cast<std::size_t>(s)]);
  };
  return {.all = geometry::error_statistics(all),
          .free = of(haptics::ContactState::free),
          .stick = of(haptics::ContactState::stick),
          .slip = of(haptics::ContactState::slip)};
}

}  // namespace palpate::apps
