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
///   d(row) = L(row - P) - 2 L(row) + L(row + P),
/// P being the carrier's period, in which light that changes evenly and the ripple that the
/// sinusoid leaves in the means cancel. It is largest for texture of two periods, and changes its
/// sign there every period, so half of it is taken half a period up and down:
///   D^2 = (d(row)^2 + (d(row - P/2)^2 + d(row + P/2)^2) / 2) / 2.
/// With |sum|, the length of the channels' common phasor (half an amplitude), the variance of the
/// phase is at least
///   0.019 max(0, (D / |sum|)^2 - 0.2^2).
/// This is the effect of an edge between two brightnesses in Hann's window of two periods, the mean
/// over its places in the window and the phases; tiles of 1 to 3 periods leave 0.011 to 0.016.
/// Below 0.2, harmonics of the sinusoid bend the means as much.
/// \param sigma [rad]
void add_texture_error(const std::vector<Demodulated>& channels, const Combined& sum,
                       const DemodulationFilter& filter, Plane& sigma);

}  // namespace palpate::sensing
