// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Warns that the friction of `unknown` contacts of a model is unknown, and what it is played with.
void tell_unknown_friction(const std::filesystem::path& folder, int unknown, double played);

/// The same of all objects of a scene.
void tell_unknown_friction(const haptics::SceneFile& file, const haptics::Scene& scene);

}  // namespace palpate::apps
