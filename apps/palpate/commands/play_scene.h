// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "shared/command_line.h"

namespace palpate::apps {

/// Plays a scene file along its paths. \param record folder for the traces; empty for none.
void play_scene(const Settings& settings, const std::filesystem::path& scene,
                const std::filesystem::path& record);

}  // namespace palpate::apps
