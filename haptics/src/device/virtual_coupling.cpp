// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/virtual_coupling.h"

#include <limits>

#include "palpate/core/require.h"

namespace palpate::haptics {

double passive_stiffness(double damping, double period, double delay) noexcept {
  return damping / (period / 2 + delay);
}

double passive_damping(double stiffness, double period, double delay) noexcept {
  return stiffness * (period / 2 + delay);
}

double quiet_stiffness(double friction, double resolution) noexcept {
  return resolution > 0 ? 2 * friction / resolution : std::numeric_limits<double>::infinity();
}

double quiet_friction(double stiffness, double resolution) noexcept {
  return stiffness * resolution / 2;
}

void check_coupling(const CouplingOptions& options) {
  require("CouplingOptions::stiffness", options.stiffness, above(0).finite(), "N/mm");
  require("CouplingOptions::safety", options.safety, above(0).at_most(1));
  require("CouplingOptions::least_damping", options.least_damping, above(0).finite(), "N s/mm");
  require("CouplingOptions::tolerance", options.tolerance, above(0).finite(), "N");
  require("CouplingOptions::most_steps", options.most_steps, at_least(1).finite());
}

double coupling_stiffness(const CouplingOptions& options, double damping, double period,
                          double delay) noexcept {
  if (options.stiffness) return *options.stiffness;
  const double declared = damping > 0 ? damping : options.least_damping;
  return options.safety * passive_stiffness(declared, period, delay);
}

}  // namespace palpate::haptics
