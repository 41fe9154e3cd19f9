// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "phase/chromatic.h"

namespace palpate::sensing {

/// Raises the standard deviation of phases where texture disturbs them: edges of print and of
/// material fit the sinusoid in part, and this part is not in the residual.
///
/// Texture shows in the light L, the sum of the channels' means, by the second difference
///   d = L(row - P) - 2 L(row) + L(row + P),
/// P being the carrier's period, in which light that changes evenly and the ripple that the
/// sinusoid leaves in the means cancel. With |sum|, the length of the channels' common phasor (half
/// an amplitude), the variance of the phase is at least
///   0.04 max(0, (d / |sum|)^2 - 0.2^2).
/// An edge anywhere in the window, of the same brightness along the rows, would ask for 0.11
/// (Hann's window of two periods, RMS over its places and the phases) and smooth shading of three
/// periods for 0.02; 0.04 is what edges in all directions leave after the averaging along the rows.
/// Below 0.2, harmonics of the sinusoid bend the means as much.
/// \param sigma [rad]
void add_texture_error(const std::vector<Demodulated>& channels, const Combined& sum,
                       const DemodulationFilter& filter, Plane& sigma);

}  // namespace palpate::sensing
