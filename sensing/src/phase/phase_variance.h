// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"

namespace palpate::sensing {

/// How unevenly the phase changes around each pixel [rad^2] (the phase derivative variance of
/// Ghiglia and Pritt): the variance of the wrapped differences to the right and downwards over 3 x
/// 3 pixels, the two added. A slope has none, however steep; a depth step has much. Pairs that
/// leave the mask do not count; pixels outside it get infinity, and so do all of an image without 3
/// x 3 pixels.
/// \param wrapped [rad] in [-pi, pi] on the mask.
/// \param variance takes the result.
void phase_variance(const Plane& wrapped, const Mask& mask, Plane& variance);

}  // namespace palpate::sensing
