// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>

#include "palpate/haptics/scene_file.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// Plays a scene file along its paths. \param record folder for the traces; empty for none.
void play_scene(const Settings& settings, const fs::path& scene, const fs::path& record);

/// Checks that each tool except `device`, the one that a device moves, has a trajectory.
/// \param path of the file, for messages. \throws InvalidInput otherwise.
void check_ways(const haptics::SceneFile& file, std::optional<std::size_t> device,
                const fs::path& path);

/// Writes the traces of all tools and objects, and the figures, into a folder.
void write_scene_traces(const fs::path& folder, const haptics::SceneFile& file,
                        const haptics::Scene& scene, const haptics::SceneTrace& trace,
                        const Json& figures);

}  // namespace palpate::apps
