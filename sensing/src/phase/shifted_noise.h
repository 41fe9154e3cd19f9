// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "phase/chromatic.h"
#include "phase/light_groups.h"
#include "phase/shifted_phase.h"

namespace palpate::sensing {

/// Variance of a value as a linear function of its light, from places in groups of similar light.
/// \param freedom degrees of freedom of each sample's variance, >= 1: the median of such variances
/// is smaller than their mean.
[[nodiscard]] LinearInLight variance_of_light(std::vector<VarianceSample> samples, int freedom);

/// Samples for three steps, whose fit leaves nothing: fourth differences of the phase along the
/// rows, each with one degree of freedom.
/// \param unit_variance of B cos phi and of B sin phi if the values have variance one.
/// \param least_amplitude B [fraction of full scale] from which on pixels are used.
[[nodiscard]] std::vector<VarianceSample> samples_between_pixels(const ShiftedChannel& channel,
                                                                 double unit_variance,
                                                                 float least_amplitude);

/// The mean square of `freedom` normal values of variance one is larger than this in one of ten
/// thousand cases (Wilson and Hilferty 1931).
[[nodiscard]] double beyond_chance(int freedom);

/// Adds to the standard deviation of each phase [rad] the error of light that blur mixes into it,
/// and marks the pixels that see mostly the light of their neighbours.
///
/// Blur of variance V, of the lens and of demosaicing, shows the phase of the place where the light
/// is: with the amplitude A and the phase phi, it is off by V grad A / A . grad phi. At the edge of
/// a surface in front of nothing that is most of a radian. V is taken to be 2 px^2. The part that
/// noise alone would show is left out.
/// \param combined without the carrier
/// \param count channels and exposures that a pixel uses: amplitudes of different ones are not
/// compared
/// \param along [rad/px] the carrier down the columns
/// \param edges output
void add_mixed_light(const Combined& combined, const Plane& count, double along, Plane& sigma,
                     Mask& edges);

}  // namespace palpate::sensing
