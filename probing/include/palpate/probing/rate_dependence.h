// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "palpate/probing/campaign.h"

namespace palpate::probing {

/// Deviation of an object from one whose displacement follows from the force alone, as in foam and
/// tissue: medians over the trials that held and whose forces and motions exceed the noise.
/// Viscosity and microslip both count.
struct RateDependence {
  int loops = 0;  ///< trials whose work was measured
  /// Of the work of the tangential force in the drag, the share that the release did not give
  /// back; NaN without loops.
  double energy_lost = std::numeric_limits<double>::quiet_NaN();
  int creeps = 0;  ///< trials whose creep was measured
  /// Of the displacement in the drag, the share that came once the force was constant; NaN without
  /// one.
  double creep = std::numeric_limits<double>::quiet_NaN();
};

/// \param options with the noise of positions and forces. A trial counts if its tangential force is
/// at least 40 times the noise of forces, and moved the tip by 10 times that of positions: an error
/// of the force by its noise on both ways then changes the share by at most 0.1.
[[nodiscard]] RateDependence rate_dependence(std::span<const TrialRecord> trials,
                                             const ProgramOptions& options = {});

}  // namespace palpate::probing
