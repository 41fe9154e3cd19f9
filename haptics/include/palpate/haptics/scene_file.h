// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "palpate/haptics/model_io.h"
#include "palpate/haptics/scene.h"
#include "palpate/haptics/scene_play.h"

namespace palpate::haptics {

/// The content of a scene file. Paths are as in the file, made relative to its folder.
struct SceneFile {
  std::vector<std::string> objects, tools;    ///< names
  std::vector<std::filesystem::path> models;  ///< folder of each object
  std::vector<PlaybackOptions> playback;      ///< of each object
  /// File of each tool. Empty: a device moves the tool; its path is one place, the origin.
  std::vector<std::filesystem::path> trajectories;
  std::vector<std::filesystem::path> sources;  ///< all files that were read
  SceneMotion motion;
  SceneOptions options;
};

/// Reads a scene, in JSON, or in YAML if the name ends in .yaml or .yml: an object with `objects`
/// (each with `name`, `model` and either `pose`, the 12 numbers of a 3 x 4 matrix row by row, or
/// `path`, a file for `read_pose_path`, and optionally `playback`, an object of fields of
/// `PlaybackOptions`, and `require`, see scene_requirement.h), `tools` (each with `name` and,
/// unless a device moves it, `trajectory`, a file for `read_trajectory_file`), and optionally
/// `near_tools`, `closest_tools` [mm], `fade_ticks` and `rate` [Hz]. docs/devices.md has an
/// example.
/// \throws FileError naming the file, the member, what is wrong with it and what would be right.
[[nodiscard]] SceneFile read_scene(const std::filesystem::path& path);

/// The scene with the models of the file, each read once for the same playback. \throws FileError
/// as `read_model`.
[[nodiscard]] Scene make_scene(
    const SceneFile& file,
    const std::function<Model(const std::filesystem::path& folder)>& read_folder = read_model);

}  // namespace palpate::haptics
