// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"

namespace palpate::sensing {

/// Computes the angle of re + i im [rad], in [-pi, pi], to within 4e-7 rad; zero where both are
/// zero.
void find_wrapped_phase(const Plane& re, const Plane& im, Plane& wrapped);

/// Computes how unevenly the phase changes around each pixel [rad^2] (the phase derivative variance
/// of Ghiglia and Pritt): the variance over 3 x 3 pixels of the wrapped differences to the right,
/// plus that of the differences downwards. A slope has zero variance, however steep; a depth step
/// has a large one. Pairs that leave the mask are ignored. Pixels outside the mask get infinity,
/// and so does a whole image smaller than 3 x 3 pixels.
/// \param wrapped [rad] in [-pi, pi] on the mask.
/// \param variance output.
void phase_variance(const Plane& wrapped, const Mask& mask, Plane& variance);

}  // namespace palpate::sensing
