// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/play_friction.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "shared/call_checks.h"
#include "shared/words.h"

namespace palpate::apps {

namespace {

void tell_unknown_friction(const std::filesystem::path& folder, int unknown, double played) {
  if (unknown == 0) return;
  spdlog::warn("{}: the friction of {} is unknown; it is played with a coefficient of {:g}{}",
               folder.string(), counted(unknown, "contact"), played,
               played == 0 ? ": the tool slides without friction." : ".");
}

}  // namespace

double checked_friction(const std::filesystem::path& folder, int unknown,
                        std::optional<double> friction) {
  if (friction && unknown == 0) {
    throw InvalidInput(fmt::format(
        "--friction: is for contacts whose friction is unknown; {} knows that of all contacts",
        folder.string()));
  }
  const double played = friction.value_or(haptics::PlaybackOptions{}.unknown_friction);
  tell_unknown_friction(folder, unknown, played);
  return played;
}

std::shared_ptr<const haptics::Playback> made_playback(const std::filesystem::path& folder,
                                                       const haptics::Model& model,
                                                       std::optional<double> friction) {
  haptics::PlaybackOptions options;
  options.unknown_friction =
      checked_friction(folder, haptics::unknown_friction_count(model), friction);
  return std::make_shared<const haptics::Playback>(model, options);
}

void add_friction_option(CLI::App& command, std::optional<double>& friction) {
  command
      .add_option("--friction", friction,
                  "Coefficient of friction of contacts where the measurements do not tell it "
                  "(default: 0)")
      ->check(within(at_least(0).finite()));
}

void tell_unknown_friction(const haptics::SceneFile& file, const haptics::Scene& scene) {
  for (std::size_t o = 0; o < file.objects.size(); ++o) {
    tell_unknown_friction(file.models[o], scene.objects()[o].playback->unknown_friction_count(),
                          haptics::PlaybackOptions{}.unknown_friction);
  }
}

}  // namespace palpate::apps
