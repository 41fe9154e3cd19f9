// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/joint_controller.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

double beyond(double value, double dead) {
  return std::copysign(std::max(std::abs(value) - dead, 0.0), value);
}

}  // namespace

JointController::JointController(const JointGains& gains) : gains_(gains) {
  require("JointGains::stiffness", gains.stiffness, at_least(0).finite(), "N mm/rad");
  require("JointGains::damping", gains.damping, at_least(0).finite(), "N mm s/rad");
  require("JointGains::integral", gains.integral, at_least(0).finite(), "N mm/(rad s)");
  require("JointGains::largest_integral", gains.largest_integral, above(0).finite(), "N mm");
  require("JointGains::smoothing", gains.smoothing, above(0).finite(), "s");
  require("JointGains::dead_band", gains.dead_band, at_least(0).finite(), "rad");
  require("JointGains::dead_speed", gains.dead_speed, at_least(0).finite(), "rad/s");
}

Eigen::Vector3d JointController::step(const Eigen::Vector3d& joints, const Eigen::Vector3d& target,
                                      const Eigen::Vector3d& target_speed, double period) noexcept {
  if (any_ && period > 0) {
    const double weight = period / (gains_.smoothing + period);
    speed_ += weight * ((joints - last_) / period - speed_);
  }
  any_ = true;
  last_ = joints;
  Eigen::Vector3d torque;
  for (int i = 0; i < 3; ++i) {
    const double error = beyond(target[i] - joints[i], gains_.dead_band);
    if (target_speed.isZero(0)) integral_[i] += gains_.integral * period * error;
    integral_[i] = std::clamp(integral_[i], -gains_.largest_integral, gains_.largest_integral);
    torque[i] = gains_.stiffness * error +
                gains_.damping * beyond(target_speed[i] - speed_[i], gains_.dead_speed) +
                integral_[i];
  }
  return torque;
}

}  // namespace palpate::probing
