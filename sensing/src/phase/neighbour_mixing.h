// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "phase/phase_noise.h"

namespace palpate::sensing {

/// Removes from each phase the light of neighbours that the averages along the rows and down the
/// window mix into it, and adds the part that may remain to its standard deviation.
///
/// A mean over pixels with variance V [px^2] has the phase of the place where the light is: with
/// the amplitude A and the phase phi, it is off by V (A' / A phi' + phi'' / 2). V is known for both
/// averages.
///
/// *Along the rows* this matters at limbs, at the edges of bright prints, and where a surface ends.
/// The derivatives come from the next pixels; the second term counts only where it is beyond the
/// noise. The lens mixes as well; its variance is taken to be 1 px^2 and adds to the deviation.
///
/// *Down the window* surfaces that bend are rounded off. The derivatives come from `mixing_reach`
/// rows up and down. The change of the phase that they give over this reach, b, counts by the share
/// b^2 / (b^2 + (6 s)^2), where s is its standard deviation: noise stays as it is. Higher
/// derivatives and the lens are not known, so the amount that is subtracted adds to the deviation.
/// \param wrapped [rad] input and output; `signal.wrapped` may be the same image.
/// \param sigma   [rad] input and output
void unmix_neighbours(const PhaseSignal& signal, const DemodulationFilter& filter, Plane& wrapped,
                      Plane& sigma);

/// [px] The number of whole periods nearest to the length of the window, so that a ripple of one
/// cycle a period does not look like a bend.
[[nodiscard]] long mixing_reach(const DemodulationFilter& filter);

}  // namespace palpate::sensing
