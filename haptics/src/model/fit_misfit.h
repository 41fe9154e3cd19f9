// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace palpate::haptics {

/// [N^2] Mean square of the errors of a field that noise does not explain. Chi^2 exceeds 1 by
/// chance, too: beyond two of its standard deviations it shows a misfit.
/// \param chi2 per degree of freedom, \param noise_floor [N] the rms that noise alone makes,
/// \param pairs of displacement and force that the field was fitted to.
[[nodiscard]] inline double fit_misfit(double chi2, double noise_floor, double pairs) {
  const double by_chance = 2 * std::sqrt(2 / (3 * pairs));
  return noise_floor * noise_floor * std::max(chi2 - 1 - by_chance, 0.0);
}

}  // namespace palpate::haptics
