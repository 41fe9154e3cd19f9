// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "scene.h"

namespace palpate::bench {

/// Folders of frames that another renderer made: in each FOLDER/SET there are `pattern.yaml`,
/// frames in `cam/` (a real camera's faults) and `clean/` with `rig.yaml` and `rig_ideal.yaml`, or
/// in `raw_cam/` and `raw_clean/` with `rig_raw.yaml` and `rig_raw_ideal.yaml`, and the truth in
/// `truth/NAME.tiff`, `truth/NAME_id.png` (0: nothing) and `truth/NAME_lit.png`. A set without
/// `train_cam/` or `train_clean/` takes the colours of the first one that has it. Sets with raw
/// frames are read from those alone: the others were bent for the projector's pose.
/// \throws FileError if a file is missing or broken.
[[nodiscard]] std::vector<Scene> rendered_scenes(const std::filesystem::path& folder);

}  // namespace palpate::bench
