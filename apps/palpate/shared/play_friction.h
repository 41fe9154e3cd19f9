// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>

#include "palpate/haptics/playback.h"
#include "palpate/haptics/scene_file.h"

namespace palpate::apps {

/// The playback of a model, with a warning if the friction of contacts is unknown.
/// \param friction coefficient of these contacts; none: `PlaybackOptions::unknown_friction`.
/// \throws InvalidInput if a friction is given and that of all contacts is known.
[[nodiscard]] std::shared_ptr<const haptics::Playback> made_playback(
    const std::filesystem::path& folder, const haptics::Model& model,
    std::optional<double> friction);

/// The coefficient with which `unknown` contacts of a model are played, with a warning if there are
/// any. Parameters and exceptions as `made_playback`.
[[nodiscard]] double checked_friction(const std::filesystem::path& folder, int unknown,
                                      std::optional<double> friction);

/// The option --friction.
void add_friction_option(CLI::App& command, std::optional<double>& friction);

/// Warns of all objects of a scene.
void tell_unknown_friction(const haptics::SceneFile& file, const haptics::Scene& scene);

}  // namespace palpate::apps
