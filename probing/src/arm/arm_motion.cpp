// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "arm/arm_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "palpate/probing/arm_reach.h"

namespace palpate::probing {
namespace {

/// Weight of the latest value in a mean with a time constant.
double latest_weight(double period, double time_constant) {
  return period / (time_constant + period);
}

constexpr double kSpeedSmoothing = 0.009;     // [s]
constexpr double kFrictionSmoothing = 0.020;  // [s] so that single encoder steps are not felt

}  // namespace

void ArmMotion::fail() const {
  std::string message = arm_.description().name + ": " + std::string(to_string(arm_.fault())) +
                        " at " + std::to_string(arm_.fault_time()) + " s of its clock";
  if (const std::string words = arm_.last_error(); !words.empty()) message += " (" + words + ")";
  throw ArmStopped(message, arm_.fault());
}

void ArmMotion::begin(const GravityModel& gravity) {
  gravity_ = gravity;
  arm_.forget_depth();
  if (!arm_.read(state_)) fail();
  take_hold();
}

int ArmMotion::ticks_in(double seconds) const {
  return static_cast<int>(std::ceil(seconds / period()));
}

void ArmMotion::take_hold() {
  speed_.setZero();
  controller_.emplace(options_.gains);
  target_ = state_.tip;
  target_joints_ = state_.joints;
}

void ArmMotion::send(const Eigen::Vector3d& torque) {
  const Eigen::Matrix3d jacobian = arm_jacobian(options_.geometry, state_.joints);
  const Eigen::Vector3d all = torque + gravity_torque(gravity_, state_.joints);
  const Eigen::Vector3d force = jacobian.transpose().inverse() * all;
  const Eigen::Vector3d tip = state_.tip, joints = state_.joints;
  const double time = state_.time;
  if (!arm_.write({.force = force, .lease = options_.limits.lease}) || !arm_.read(state_)) fail();
  const double passed = state_.time - time;
  if (!(passed > 0)) return;
  speed_ += latest_weight(passed, kSpeedSmoothing) * ((state_.tip - tip) / passed - speed_);
  deflection_ = (deflection_ + (state_.joints - joints) / options_.presliding)
                    .cwiseMax(-1.0)
                    .cwiseMin(1.0)
                    .eval();
  deflection_smooth_ +=
      latest_weight(passed, kFrictionSmoothing) * (deflection_ - deflection_smooth_);
}

Eigen::Vector3d ArmMotion::control(const Eigen::Vector3d& joints) {
  const Eigen::Vector3d torque =
      controller_->step(state_.joints, joints, (joints - target_joints_) / period(), period());
  target_joints_ = joints;
  const Eigen::Matrix3d jacobian = arm_jacobian(options_.geometry, state_.joints);
  Eigen::Vector3d force = jacobian.transpose().inverse() * torque;
  send(torque);
  return force;
}

Eigen::Vector3d ArmMotion::hold() { return control(target_joints_); }

bool ArmMotion::move_to(const Eigen::Vector3d& place, double speed, double deadline) {
  const Eigen::Vector3d from = target_;
  // Check the path first, because near the limits of the links small forces need large torques.
  constexpr double kLook = 5;  // [mm]
  const ReachOptions links{.geometry = options_.geometry};
  const int looks = std::max(1, static_cast<int>(std::ceil((place - from).norm() / kLook)));
  for (int i = 1; i <= looks; ++i) {
    if (reach_of(from + (place - from) * i / looks, links) != Reach::reachable) return false;
  }
  const int ticks = std::max(1, ticks_in((place - from).norm() / speed));
  for (int i = 1; i <= ticks; ++i) {
    // Start and end gently, so that the tip does not overshoot and reverse the friction.
    const double t = static_cast<double>(i) / ticks;
    const Eigen::Vector3d next = from + (place - from) * (t * t * (3 - 2 * t));
    const std::optional<Eigen::Vector3d> joints = joints_at(options_.geometry, next);
    if (!joints || state_.time + period() > deadline) return false;
    target_ = next;
    control(*joints);
  }
  return true;
}

void ArmMotion::set_internal_torque(const Eigen::Vector3d& torque) {
  if (options_.friction == FrictionCompensation::none) return;
  internal_ = torque;
  for (int i = 0; i < 3; ++i) {
    const double friction = options_.sliding_friction * gravity_.friction[i];
    deflection_then_[i] = friction > 0 ? std::clamp(torque[i] / friction, -1.0, 1.0) : 0.0;
  }
  deflection_ = deflection_smooth_ = deflection_then_;
}

Eigen::Vector3d ArmMotion::turned_torque() const {
  if (options_.friction != FrictionCompensation::followed) return Eigen::Vector3d::Zero();
  return options_.sliding_friction *
         gravity_.friction.cwiseMax(0).cwiseProduct(deflection_smooth_ - deflection_then_);
}

Eigen::Vector3d ArmMotion::internal_force() const {
  const Eigen::Matrix3d jacobian = arm_jacobian(options_.geometry, state_.joints);
  return jacobian.transpose().inverse() * (internal_ + turned_torque());
}

Eigen::Vector3d ArmMotion::pushing_torque(const Eigen::Vector3d& force) const {
  return arm_jacobian(options_.geometry, state_.joints).transpose() * force + internal_ +
         turned_torque();
}

void ArmMotion::push(const Eigen::Vector3d& force) { send(pushing_torque(force)); }

void ArmMotion::push_with_dither(const Eigen::Vector3d& force, double seconds) {
  const double periods = seconds * options_.dither_frequency;
  const double amplitude = options_.dither * std::min(1.0, periods);
  Eigen::Vector3d oscillation;
  // In turn, so that the tip does not swing along one direction.
  for (int i = 0; i < 3; ++i)
    oscillation[i] = amplitude * std::sin(2 * std::numbers::pi * (periods + i / 3.0));
  send(pushing_torque(force) + oscillation);
}

Eigen::Vector3d ArmMotion::torque_of(const Eigen::Vector3d& force) const {
  return arm_jacobian(options_.geometry, state_.joints).transpose() * force +
         gravity_torque(gravity_, state_.joints);
}

}  // namespace palpate::probing
