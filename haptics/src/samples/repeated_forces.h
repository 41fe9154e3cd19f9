// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// A force that was applied several times: a group with the same normal force.
struct RepeatedForce {
  double stiffness = 0;  ///< [N/mm] how the force changes with the settled position there
  /// [N^2] of the difference between the recorded normal force and that from the position
  double variance = 0;
  int degrees_of_freedom = 0;
};

/// The groups of a contact whose positions give the force, without outliers (see `realign`).
[[nodiscard]] std::vector<RepeatedForce> repeated_forces(const probing::Contact& contact,
                                                         std::span<const probing::Sample> samples);

/// [N] The standard deviation of repeated forces: what they scatter beyond what the noise of
/// positions [mm] explains; 0 if that is not much.
[[nodiscard]] double repeated_force_noise(std::span<const RepeatedForce> groups,
                                          double displacement_noise);

}  // namespace palpate::haptics
