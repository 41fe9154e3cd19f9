// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/prober.h"
#include "palpate/probing/specimen.h"

namespace palpate::probing {

/// Errors of a simulated arm, and the time it takes.
struct QuasiStaticArmOptions {
  std::uint64_t seed = 1;
  double position_noise = 0.02;    ///< [mm] standard deviation of each coordinate; >= 0
  double position_quantum = 0.03;  ///< [mm] to which positions are rounded; >= 0
  double force_noise = 0.01;  ///< [N] of each component of an applied force; half of the variance
                              ///< stays during a trial; >= 0
  double location_noise = 0.02;   ///< [mm] of the place of a touch, along the surface; >= 0
  double touch_noise = 0.06;      ///< [mm] of the depth at which a touch is noticed; >= 0
  double kinetic_friction = 0.9;  ///< coefficient while sliding over that at rest; in (0, 1]
  double tip_compliance =
      0.05;                     ///< [mm/N] tangential, of the tip's contact: causes microslip; >= 0
  double longest_slide = 10;    ///< [mm] after which the arm gives up; > 0
  double time_constant = 0.3;   ///< [s] with which the object comes to rest; > 0
  double settled_speed = 0.01;  ///< [mm/s] below which the tip rests; > 0
  double speed = 30;            ///< [mm/s] of travel (thesis 6.2.1); > 0
  double touch_seconds = 3;     ///< [s] of an approach with the estimate of internal forces; >= 0
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< [mm] the tip before the first action
};

/// An arm that probes a specimen, for campaigns: it knows equilibria only, not the motion between
/// them.
///
/// The tip rests where the specimen says, with the errors above. It slips if the force that is
/// really applied leaves the friction cone; it then slides along the tangential force until kinetic
/// friction holds it, the surface ends, or it has slid too far. Below the limit, releasing the
/// tangential force T under the normal force N leaves a part of the motion of the contact,
///   3/2 C mu N [2 (1 - T / (2 mu N))^(2/3) - (1 - T / (mu N))^(2/3) - 1]
/// with C = `tip_compliance` (microslip of a sphere: Mindlin and Deresiewicz 1953). It comes to
/// rest exponentially, and what is left at `settled_speed` stays; a retarded part of the object
/// creeps with its own time. If the specimen has no equilibrium, the tip does not come to rest.
///
/// Each random number is a hash of the seed, the trial and the action: a trial gives the same
/// result whatever came before it.
/// \throws InvalidInput from the function that makes it, if an option is outside its range.
[[nodiscard]] std::unique_ptr<Prober> make_quasi_static_arm(
    std::shared_ptr<const Specimen> specimen, const QuasiStaticArmOptions& options = {});

}  // namespace palpate::probing
