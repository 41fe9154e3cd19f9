// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene.h"

namespace palpate::bench {

/// The same scene as a camera with a quarter of the pixels sees it: each is the mean of four. The
/// truth is the mean of the four depths, and counts where all four do.
/// Frames must have an even number of rows and columns, the camera no lens distortion to speak of.
[[nodiscard]] Scene half_resolution(Scene scene);

}  // namespace palpate::bench
