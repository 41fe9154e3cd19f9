// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/bake_model.h"

namespace palpate::haptics {

probing::ContactPlan plan_bake(const probing::Specimen& specimen, probing::PlanOptions options) {
  constexpr double kLowest = 0.05, kHighest = 0.93;
  options.lowest_force = kLowest * options.max_force;
  options.highest_force = kHighest * options.max_force;
  return probing::plan_contacts(specimen.surface(), options);
}

BuildOptions exact_samples(double max_force) {
  // Errors that remain in the samples of a computed specimen: far less than the noise of an arm.
  constexpr double kDisplacement = 0.005;  // [mm]
  constexpr double kForce = 1.0 / 1500;    // of the largest one
  BuildOptions options;
  options.fit.noise.displacement = kDisplacement;
  options.force_noise = kForce * max_force;
  options.fit.compare_always = true;
  options.friction.steady_error = 0;
  return options;
}

}  // namespace palpate::haptics
