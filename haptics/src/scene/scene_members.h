// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate::haptics {

/// The members that a scene file, and each of its objects, may have. `require` and `budget` are for
/// those who make models (scene_requirement.h).
inline const std::vector<std::string> kSceneMembers{
    "objects", "tools", "near_tools", "closest_tools", "fade_ticks", "rate", "budget"};
inline const std::vector<std::string> kObjectMembers{"name", "model",    "pose",
                                                     "path", "playback", "require"};

}  // namespace palpate::haptics
