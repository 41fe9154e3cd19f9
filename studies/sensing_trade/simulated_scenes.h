// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene.h"

namespace palpate::bench {

/// A camera, characterised by its noise.
struct CameraNoise {
  double percent;    ///< of full scale: standard deviation at half of it
  double full_well;  ///< electrons; 0: no noise
};
/// The second one is the default of the virtual sensor. All have a read noise of 20 electrons.
inline constexpr CameraNoise kCameraNoises[] = {{0, 0}, {0.67, 12000}, {1.45, 3000}, {3, 1000}};
inline constexpr CameraNoise kUsualNoise = kCameraNoises[1];

/// Scenes in front of the bundled rig (demo/), seen by a Bayer camera with a blur of 1 px and 8
/// bits: tilted planes, folds of up to 50 degrees, a scanned hand in front of a wall, and a curved
/// wall with a printed texture.
[[nodiscard]] std::vector<Scene> smooth_scenes(const CameraNoise& noise = kUsualNoise);

/// Scenes that mislead a decoder: colours that absorb stripes, gloss, steps of whole periods,
/// wires, too much and too little light, defocus and motion during the exposure.
[[nodiscard]] std::vector<Scene> hard_scenes();

/// Objects of one colour, a scene for each colour: an upright cylinder and a ball in front of a
/// white wall, a curved wall and a tilted one. Pixels count if the object reflects their stripe: by
/// at least a tenth of the stripe that it reflects of white.
[[nodiscard]] std::vector<Scene> painted_scenes();

}  // namespace palpate::bench
