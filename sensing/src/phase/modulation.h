// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "phase/chromatic.h"

namespace palpate::sensing {

/// What a sinusoid must have for its phase to mean something.
struct ModulationLimits {
  bool colored = true;       ///< light that all channels share is not the projector's
  double min_amplitude = 0;  ///< of the sum of all channels, fraction of full scale; > 0
  double min_ratio = 0;      ///< amplitude / mean of the projector's light; >= 0
};

/// The pixels of `lit` that keep both limits. The mean is the sum over all channels, less three
/// times the smallest iff `colored`.
void find_modulated(const Combined& combined, const std::vector<Demodulated>& channels,
                    const Mask& lit, const ModulationLimits& limits, Mask& modulated);

}  // namespace palpate::sensing
