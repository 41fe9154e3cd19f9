// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/force_field.h"
#include "palpate/haptics/pressing_estimate.h"

namespace palpate::haptics {

/// A convex field whose z axis is the direction of pressing: ridges along z follow the curve within
/// its reach (where it falls, they stay level) and continue it straight for a quarter of the reach.
/// Two springs across have `lateral_ratio` times the curve's secant stiffness at 0.7 times the
/// reach. Zero if the curve has no reach or no force.
/// \param max_bases of the field, the springs among them; >= kFewestPressingBases.
[[nodiscard]] ForceField pressing_field(const PressingCurve& curve, double lateral_ratio,
                                        int max_bases);

/// One ridge along the pressing and two springs across.
inline constexpr int kFewestPressingBases = 3;

}  // namespace palpate::haptics
