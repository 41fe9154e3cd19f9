// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/device_call.h"
#include "palpate/haptics/scene_file.h"
#include "palpate/haptics/scene_world.h"

namespace palpate::apps {

/// What a session of the loop must know to be computed again: its models.
[[nodiscard]] std::string session_text(const DeviceCall& call);

/// A scene in which a device moves a tool.
struct SceneOfDevice {
  haptics::SceneFile file;
  std::size_t tool = 0;          ///< of the device
  std::vector<fs::path> inputs;  ///< files and folders that were read
};

/// \param tool its name; empty: the first one. \throws FileError, or InvalidInput for another name.
[[nodiscard]] SceneOfDevice read_scene_of_device(const fs::path& path, const std::string& tool);
[[nodiscard]] std::string session_text(const SceneOfDevice& scene);
/// The scene before its first tick, with ticks of the device [s].
/// \throws InvalidInput naming a model that cannot be felt.
[[nodiscard]] std::shared_ptr<haptics::SceneWorld> world_of(const SceneOfDevice& scene,
                                                            double tick);

}  // namespace palpate::apps
