// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "phase/chromatic.h"

namespace palpate::sensing {

/// Lower limits of a sinusoid whose phase is usable.
struct ModulationLimits {
  bool colored = true;       ///< light common to all channels is not the projector's
  double min_amplitude = 0;  ///< of the sum of all channels, fraction of full scale; > 0
  double min_ratio = 0;      ///< amplitude / mean of the projector's light; >= 0
};

/// Finds the pixels of `lit` that satisfy both limits. The mean is the sum over all channels, minus
/// three times the smallest channel iff `colored`.
void find_modulated(const Combined& combined, const std::vector<Demodulated>& channels,
                    const Mask& lit, const ModulationLimits& limits, Mask& modulated);

}  // namespace palpate::sensing
