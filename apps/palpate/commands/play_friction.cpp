// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/play_friction.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "palpate/error.h"

namespace palpate::apps {

std::shared_ptr<const haptics::Playback> made_playback(const std::filesystem::path& folder,
                                                       const haptics::Model& model,
                                                       std::optional<double> friction) {
  haptics::PlaybackOptions options;
  options.unknown_friction = friction.value_or(options.unknown_friction);
  auto playback = std::make_shared<const haptics::Playback>(model, options);
  const int unknown = playback->unknown_friction_count();
  if (friction && unknown == 0) {
    throw InvalidInput(fmt::format(
        "--friction: is for contacts whose friction is unknown; {} knows that of all contacts",
        folder.string()));
  }
  tell_unknown_friction(folder, unknown, options.unknown_friction);
  return playback;
}

void tell_unknown_friction(const std::filesystem::path& folder, int unknown, double played) {
  if (unknown == 0) return;
  spdlog::warn(
      "{}: the friction of {} contacts is unknown; it is played with a coefficient of {:g}{}",
      folder.string(), unknown, played, played == 0 ? ": the tool slides without friction." : ".");
}

void tell_unknown_friction(const haptics::SceneFile& file, const haptics::Scene& scene) {
  for (std::size_t o = 0; o < file.objects.size(); ++o) {
    tell_unknown_friction(file.models[o], scene.objects()[o].playback->unknown_friction_count(),
                          haptics::PlaybackOptions{}.unknown_friction);
  }
}

}  // namespace palpate::apps
