// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// The same for each joint. Defaults suit an arm of 0.08 kg at a distance of 200 mm.
struct JointGains {
  double stiffness = 6500;        ///< [N mm/rad] >= 0
  double damping = 500;           ///< [N mm s/rad] >= 0
  double integral = 30000;        ///< [N mm/(rad s)] >= 0; grows only while the target rests
  double largest_integral = 400;  ///< [N mm] > 0
  double smoothing = 0.01;        ///< [s] of the speed; > 0
  /// [rad], [rad/s] Quantisation of encoders at rest: errors and speeds count only beyond these, so
  /// that the torque at rest is the integral alone and does not shake the joint. >= 0
  double dead_band = 2.2e-4;
  double dead_speed = 0.01;
};

/// Moves the joints of a force-controlled arm and keeps them where they are: a PID controller
/// (thesis 4.4.3). The integral waits while the target moves: otherwise it would overshoot at the
/// end and reverse the friction that it is to measure. Gravity is to be added by the caller.
/// Real-time safe.
class JointController {
 public:
  /// \throws InvalidInput on a gain outside its range.
  explicit JointController(const JointGains& gains = {});

  /// [N mm] for joints [rad] measured `period` [s] after the last; target speed in rad/s.
  Eigen::Vector3d step(const Eigen::Vector3d& joints, const Eigen::Vector3d& target,
                       const Eigen::Vector3d& target_speed, double period) noexcept;

 private:
  JointGains gains_;
  bool any_ = false;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d speed_ = Eigen::Vector3d::Zero();     // [rad/s] smoothed
  Eigen::Vector3d integral_ = Eigen::Vector3d::Zero();  // [N mm]
};

}  // namespace palpate::probing
