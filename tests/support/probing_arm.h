// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "palpate/probing/arm_prober.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/probing_program.h"
#include "palpate/probing/virtual_arm.h"

// A virtual arm over a specimen, as tests of the prober use it.
namespace palpate::probing::support {

inline ArmProberOptions prober_over(const Specimen& specimen) {
  ArmProberOptions options;
  options.calibration = sweeps_above_surface();
  options.calibration.angles = 5;
  options.calibration.speed = 0.3;
  options.T_world_base = mount_over(specimen.surface(), options.geometry);
  return options;
}

inline VirtualArmOptions virtual_arm_for(const ArmProberOptions& options) {
  VirtualArmOptions result;
  result.T_world_base = options.T_world_base;
  return result;
}

/// Gravity as the virtual arm measures it, once in a program; it depends on the arm alone.
inline const GravityModel& measured_gravity() {
  static const GravityModel gravity = [] {
    const ArmProberOptions options = prober_over(*make_specimen(Sheet{}));
    VirtualArm arm(nullptr, virtual_arm_for(options));
    ArmProber prober(arm, options);
    prober.calibrate();
    return *prober.gravity();
  }();
  return gravity;
}

/// A trial that presses along a contact's normal with `normal` [N] and pulls along the world's X.
inline TrialOrder pull_at(long long trial, const Eigen::Vector3d& place,
                          const Eigen::Vector3d& outwards, double normal, double tangential) {
  const Eigen::Vector3d along = (Eigen::Vector3d::UnitX() - outwards * outwards.x()).normalized();
  return {.trial = trial,
          .contact = {.id = 0, .position = place, .normal = outwards},
          .direction = tangential > 0 ? 0 : -1,
          .normal_force = -normal * outwards,
          .tangential_force = tangential * along};
}

}  // namespace palpate::probing::support
