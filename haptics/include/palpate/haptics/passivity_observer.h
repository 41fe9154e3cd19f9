// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// The energy that a user got from a device minus the energy put in (Hannaford and Ryu 2002).
struct GivenEnergy {
  double now = 0;      ///< [N mm] work of the device on the user since it last had no force
  double largest = 0;  ///< [N mm] >= 0, of `now`
  /// [N mm] >= 0: the sum over all touches, each from no force to no force, of what it gave. A
  /// passive object gives nothing in any.
  double in_touches = 0;
  long long touches = 0, giving = 0;  ///< touches that ended, and those that gave energy
};

/// Watches the energy that flows through a device. It only reports.
class PassivityObserver {
 public:
  /// Call once a tick. Real-time safe. \param device [mm] position by the encoders; \param force
  /// [N] on the user that acts from now on, until the next tick.
  void observe(const Eigen::Vector3d& device, const Eigen::Vector3d& force) noexcept;
  /// The force ends here, wherever the device is. Real-time safe.
  void release() noexcept { observe(device_, Eigen::Vector3d::Zero()); }
  [[nodiscard]] const GivenEnergy& given() const noexcept { return given_; }

 private:
  GivenEnergy given_;
  bool any_ = false;
  Eigen::Vector3d device_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate::haptics
