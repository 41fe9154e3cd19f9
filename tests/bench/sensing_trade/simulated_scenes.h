// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene.h"

namespace palpate::bench {

/// A camera as good or bad as the noise it has.
struct CameraNoise {
  double percent;    ///< of full scale: standard deviation at half of it
  double full_well;  ///< electrons; 0: no noise
};
/// The second one is the virtual sensor's own. All read with 20 electrons of noise.
inline constexpr CameraNoise kCameraNoises[] = {{0, 0}, {0.67, 12000}, {1.45, 3000}, {3, 1000}};
inline constexpr CameraNoise kUsualNoise = kCameraNoises[1];

/// Before the bundled rig (demo/), as a Bayer camera with a blur of 1 px and 8 bits sees them:
/// planes that are tilted, folds of up to 50 degrees, a scanned hand before a wall, and a curved
/// wall with a printed texture.
[[nodiscard]] std::vector<Scene> smooth_scenes(const CameraNoise& noise = kUsualNoise);

/// What misleads a decoder: colours that swallow stripes, gloss, steps of whole periods, wires,
/// too much and too little light.
[[nodiscard]] std::vector<Scene> hard_scenes();

}  // namespace palpate::bench
