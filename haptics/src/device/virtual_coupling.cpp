// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/virtual_coupling.h"

#include <limits>

#include "palpate/core/idle_fields.h"

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

void visit(CouplingOptions& options, FieldVisitor& visitor) {
  constexpr bool kExpert = true;
  visitor.begin("CouplingOptions");
  visitor.flag({"coupling",
                "Couple the device to the tool by a spring, which the user feels in place of an "
                "object that is stiffer than the device can display"},
               options.on);
  visitor.real({"coupling_stiffness",
                "Stiffness of the spring. Without it: coupling_safety times the largest that is "
                "passive by the damping and the delay that the device declares",
                "N/mm"},
               options.stiffness, above(0).finite());
  visitor.real({"coupling_safety",
                "Share of the passive stiffness that the spring has; the rest of the damping calms "
                "the hand",
                "", kExpert},
               options.safety, above(0).at_most(1));
  visitor.real(
      {"coupling_damping", "Damping taken for devices that declare none: that of a light grip",
       "N s/mm", kExpert},
      options.least_damping, above(0).finite());
  visitor.real(
      {"coupling_tolerance", "Allowed difference of the forces of spring and model", "N", kExpert},
      options.tolerance, above(0).finite());
  visitor.whole(
      {"coupling_steps", "Largest number of evaluations of the model in a tick", "", kExpert},
      options.most_steps, at_least(1));
}

void check_coupling(const CouplingOptions& options) {
  static_cast<void>(in_range(options));
  if (!options.on) {
    refuse_idle(options, "coupling",
                {"coupling_stiffness", "coupling_safety", "coupling_damping", "coupling_tolerance",
                 "coupling_steps"});
  }
  if (options.stiffness)
    refuse_idle(options, "coupling_stiffness", {"coupling_safety", "coupling_damping"});
}

double coupling_stiffness(const CouplingOptions& options, double damping, double period,
                          double delay) noexcept {
  if (options.stiffness) return *options.stiffness;
  const double declared = damping > 0 ? damping : options.least_damping;
  return options.safety * passive_stiffness(declared, period, delay);
}

}  // namespace palpate::haptics
