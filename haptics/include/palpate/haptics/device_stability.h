// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "palpate/haptics/model.h"
#include "palpate/haptics/simulated_hand.h"
#include "palpate/haptics/virtual_coupling.h"

namespace palpate::haptics {

/// [N/mm] Stiffness of a model: of each contact the largest eigenvalue of its stiffness, over
/// displacements into the object, straight and by 45 degrees to eight sides, up to a force. If the
/// model depends on the rate, it is that of sudden motions, which an unstable loop makes.
struct ModelStiffness {
  double median = 0;
  double largest = 0;
  long long stiffest = 0;  ///< id of the contact with the largest
};

/// \param highest_force [N] > 0.
/// \throws InvalidInput if `check_model` throws or the force is not > 0.
[[nodiscard]] ModelStiffness model_stiffness(const Model& model, double highest_force = 3.3);

/// Returns true if a hand that presses with 1 N on a wall of this stiffness [N/mm] comes to rest:
/// in the last eighth of twelve decay times of the hand (at least 1 s) it swings less than half as
/// much as in the second eighth, or by less than three steps of the encoder.
/// \throws InvalidInput on an option outside its range, or a stiffness that is not > 0.
[[nodiscard]] bool presses_calmly(const HandOptions& hand, const CouplingOptions& coupling,
                                  double stiffness);

/// [N/mm] The stiffest wall on which `presses_calmly` returns true, from 1e-3 to 1e3, to 1 %.
[[nodiscard]] double largest_calm_stiffness(const HandOptions& hand,
                                            const CouplingOptions& coupling);

}  // namespace palpate::haptics
