// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"

namespace palpate::sensing {

/// Computes the angle of re + i im [rad], in [-pi, pi], to within 4e-7 rad; zero where both are
/// zero.
void find_wrapped_phase(const Plane& re, const Plane& im, Plane& wrapped);

}  // namespace palpate::sensing
