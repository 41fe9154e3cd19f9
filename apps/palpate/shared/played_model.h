// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "palpate/haptics/model.h"
#include "palpate/haptics/playback.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// \throws InvalidInput naming the folder if the model cannot be felt with a device.
[[nodiscard]] haptics::Model playable_model(const fs::path& folder);

/// The same, ready for the loop, as `made_playback`.
[[nodiscard]] std::shared_ptr<const haptics::Playback> playback_of(
    const fs::path& folder, const haptics::PlaybackOptions& options = {});

/// What tells a model from another one, for sessions.
[[nodiscard]] std::string print_of_model(const fs::path& folder);

/// What a session of the loop must know to be computed again: its models, in the order of their
/// use, and how they are played.
[[nodiscard]] std::string session_text(const std::vector<fs::path>& models,
                                       const haptics::PlaybackOptions& options);

/// What `session_text` wrote.
struct SessionModels {
  std::vector<std::string> fingerprints;  ///< of its models; none: the session of something else
  haptics::PlaybackOptions playback;
  std::string words;  ///< for messages: "model/", or "a scene"
};
[[nodiscard]] SessionModels models_of(const std::string& session);

}  // namespace palpate::apps
