// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"

namespace palpate::sensing {

/// Finds the contrast (a - b) / (a + b) of the light from before each row to behind it, in its
/// column, each continued to the row: even shading has none. Where the light is not known far
/// enough to continue it, the contrast is that of the places half a period away.
/// \param light    averages over two periods, > 0; NaN where unknown.
/// \param half     half a period [px], > 0.
/// \param contrast output; NaN where unknown.
void find_light_steps(const Plane& light, long half, Plane& contrast);

}  // namespace palpate::sensing
