// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "commands/device_call.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/playback.h"

namespace palpate::apps {

/// What a session of the loop must know to be computed again: its models.
[[nodiscard]] std::string session_text(const DeviceCall& call);

/// \throws InvalidInput naming the folder if the model cannot be felt with a device.
[[nodiscard]] haptics::Model playable_model(const std::filesystem::path& folder);

/// The same, ready for the loop.
[[nodiscard]] std::shared_ptr<const haptics::Playback> playback_of(
    const std::filesystem::path& folder);

}  // namespace palpate::apps
