// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene.h"

namespace palpate::bench {

/// The same scene for a camera with a quarter of the pixels: each is the mean of four. The true
/// depth is the mean of the four depths, and a pixel counts if all four do. Frames must have an
/// even number of rows and columns, and the camera almost no lens distortion.
[[nodiscard]] Scene half_resolution(Scene scene);

}  // namespace palpate::bench
