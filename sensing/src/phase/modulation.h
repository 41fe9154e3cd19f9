// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "phase/chromatic.h"

namespace palpate::sensing {

/// Finds the pixels of `lit` whose sinusoid has at least this amplitude.
/// \param min_amplitude of the sum of all channels, fraction of full scale; > 0.
void find_modulated(const Combined& combined, const Mask& lit, double min_amplitude,
                    Mask& modulated);

/// Takes the pixels out of a mask whose phase has a larger predicted standard deviation, or none.
/// \param sigma [rad]
void drop_uncertain(const Plane& sigma, double max_sigma, Mask& modulated);

}  // namespace palpate::sensing
