// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/play_friction.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "palpate/core/error.h"
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

}  // namespace palpate::apps
