// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "palpate/haptics/playback.h"
#include "palpate/haptics/scene_file.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The playback of a model, with a warning if the friction of contacts is unknown.
/// \throws InvalidInput if the options give such a friction and that of all contacts is known.
[[nodiscard]] std::shared_ptr<const haptics::Playback> made_playback(
    const fs::path& folder, const haptics::Model& model,
    const haptics::PlaybackOptions& options = {});

/// Warns if contacts of a model have an unknown friction, for which `played` is taken.
/// \param unknown number of such contacts.
/// \throws InvalidInput as `made_playback`.
void check_friction(const fs::path& folder, int unknown, double played);

/// Warns of all objects of a scene whose friction is unknown.
void tell_unknown_friction(const haptics::SceneFile& file, const haptics::Scene& scene);

}  // namespace palpate::apps
