// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "palpate/geometry/error_statistics.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/scene_file.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// \throws InvalidInput naming the folder if the model cannot be felt with a device.
[[nodiscard]] haptics::Model playable_model(const fs::path& folder);

/// Returns the playback of such a model, as `made_playback`.
[[nodiscard]] std::shared_ptr<const haptics::Playback> playback_of(
    const fs::path& folder, const haptics::PlaybackOptions& options = {});

/// Returns the fingerprint of a model, for sessions.
[[nodiscard]] std::string print_of_model(const fs::path& folder);

/// Returns the text that the replay of a session of the loop needs: its models, in the order of
/// their use, and their options of playback.
[[nodiscard]] std::string session_text(const std::vector<fs::path>& models,
                                       const haptics::PlaybackOptions& options);

/// The content of a text of `session_text`.
struct SessionModels {
  std::vector<std::string> fingerprints;  ///< of its models; none: the session of something else
  haptics::PlaybackOptions playback;
  std::string words;  ///< for messages: "model/", or "a scene"
};
[[nodiscard]] SessionModels models_of(const std::string& session);

/// The playback of a model, with a warning if the friction of contacts is unknown.
/// \throws InvalidInput if the options give such a friction and that of all contacts is known.
[[nodiscard]] std::shared_ptr<const haptics::Playback> made_playback(
    const fs::path& folder, const haptics::Model& model,
    const haptics::PlaybackOptions& options = {});

/// Warns if contacts of a model have an unknown friction, for which `played` is used.
/// \param unknown number of such contacts.
/// \throws InvalidInput as `made_playback`.
void check_friction(const fs::path& folder, int unknown, double played);

/// Warns of all objects of a scene whose friction is unknown.
void tell_unknown_friction(const haptics::SceneFile& file, const haptics::Scene& scene);

/// Duration of single steps of the haptic loop [us], by contact state.
struct StepTimes {
  geometry::ErrorStatistics all, free, stick, slip;
};

/// Plays a trajectory again and measures every step.
[[nodiscard]] StepTimes time_steps(const haptics::Playback& playback,
                                   std::span<const haptics::TrajectoryPoint> trajectory);

}  // namespace palpate::apps
