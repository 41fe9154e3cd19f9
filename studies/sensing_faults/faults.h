// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene.h"

namespace palpate::bench {

/// Something wrong in what a user passes to the decoder.
struct Fault {
  std::string name;
  std::function<void(Scene&)> apply;  ///< the truth moves with the frame
};

/// Frames that are not as the camera saw them.
[[nodiscard]] std::vector<Fault> faults_of_frames();

/// Files of rig, pattern and colours that belong to something else.
[[nodiscard]] std::vector<Fault> faults_of_files();

}  // namespace palpate::bench
