// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/probing/arm_prober.h"
#include "palpate/probing/force_compensation.h"
#include "palpate/probing/joint_controller.h"

namespace palpate::probing {

/// The control loop of an arm: one call of `control`, `hold` or a push is one tick. All quantities
/// are in the frame of the base. Each function throws ArmStopped after a fault.
class ArmMotion {
 public:
  ArmMotion(devices::SafeDevice& arm, const ArmProberOptions& options)
      : arm_(arm), options_(options) {}

  /// Discards the state of all previous motion. The motors have just been switched on.
  void begin(const GravityModel& gravity);

  [[nodiscard]] const devices::DeviceState& state() const { return state_; }
  [[nodiscard]] const Eigen::Vector3d& speed() const { return speed_; }  ///< [mm/s] smoothed
  [[nodiscard]] double period() const { return arm_.description().period; }
  [[nodiscard]] int ticks_in(double seconds) const;

  /// Starts joint control at the current position of the tip, after forces were applied.
  void take_hold();
  /// Moves the tip along a line. False if a point of it is out of reach, or `deadline` [s] passes.
  [[nodiscard]] bool move_to(const Eigen::Vector3d& place, double speed, double deadline);
  /// Holds the tip where `move_to` or `take_hold` left it. \return [N] of the controller.
  Eigen::Vector3d hold();

  /// [N mm] Torque that the joints need besides gravity, measured with the arm at rest in free
  /// space.
  void set_internal_torque(const Eigen::Vector3d& torque);
  /// Applies a force [N] at the tip, with gravity and internal forces compensated.
  void push(const Eigen::Vector3d& force);
  /// The same, `seconds` after the torques of the joints began to oscillate.
  void push_with_dither(const Eigen::Vector3d& force, double seconds);
  /// [N] at the tip that `push` adds against internal forces, now.
  [[nodiscard]] Eigen::Vector3d internal_force() const;

  /// [N mm] of the motors for a force at the tip, with gravity.
  [[nodiscard]] Eigen::Vector3d torque_of(const Eigen::Vector3d& force) const;

 private:
  /// [N mm] By which the friction of the joints has changed since it was measured.
  [[nodiscard]] Eigen::Vector3d turned_torque() const;
  /// [N mm] besides gravity.
  [[nodiscard]] Eigen::Vector3d pushing_torque(const Eigen::Vector3d& force) const;
  Eigen::Vector3d control(const Eigen::Vector3d& joints);
  void send(const Eigen::Vector3d& torque);
  [[noreturn]] void fail() const;

  devices::SafeDevice& arm_;
  const ArmProberOptions& options_;
  GravityModel gravity_;
  std::optional<JointController> controller_;
  devices::DeviceState state_;
  Eigen::Vector3d speed_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_ = Eigen::Vector3d::Zero();         // [mm]
  Eigen::Vector3d target_joints_ = Eigen::Vector3d::Zero();  // [rad]
  // Friction: the measured torque, and the deflection of each joint's friction in [-1, 1] at that
  // measurement, now, and smoothed.
  Eigen::Vector3d internal_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d deflection_then_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d deflection_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d deflection_smooth_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate::probing
