// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decode/plausibility.h"
#include "image/image_plane.h"

namespace palpate::sensing {

/// Marks the patches of depths that the stripe colours do not confirm. A patch is a connected set
/// of pixels with a depth. It is confirmed if at least two colours of the pattern are found in it
/// mostly where its depths predict them. One colour is no evidence: on a saturated red surface
/// every visible stripe looks red, so a prediction of red always agrees.
/// \param z      [mm] NaN where unknown.
/// \param colors number of colours of the pattern.
void find_unproven_patches(const Plane& z, const ColorSays& says, int colors, Mask& marked);

}  // namespace palpate::sensing
