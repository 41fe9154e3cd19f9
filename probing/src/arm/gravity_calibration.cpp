// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/gravity_calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

/// Moves an arm along straight lines in joint space, and holds it.
class PoseHolder {
 public:
  PoseHolder(devices::Device& arm, const GravityCalibration& calibration)
      : arm_(arm), calibration_(calibration), controller_(calibration.gains) {
    read();
    at_ = target_ = state_.joints;
  }

  void move_to(const Eigen::Vector3d& joints, double speed) {
    const double way = (joints - at_).cwiseAbs().maxCoeff();
    const int ticks = std::max(1, ticks_in(way / speed));
    const Eigen::Vector3d from = at_;
    for (int i = 1; i <= ticks; ++i) {
      // Start and end gently, so that the tip does not overshoot and reverse the friction.
      const double t = static_cast<double>(i) / ticks;
      step(from + (joints - from) * (t * t * (3 - 2 * t)));
    }
    at_ = joints;
  }

  void settle() {
    for (int i = ticks_in(calibration_.settling); i > 0; --i) step(at_);
  }

  /// Approaches the joints along `direction`, slowly at the end, and holds them.
  HeldPose hold(const Eigen::Vector3d& joints, const Eigen::Vector3i& direction) {
    constexpr double kLastPart = 0.02;  // [rad]
    constexpr double kSlow = 3;         // times slower
    move_to(joints - kLastPart * direction.cast<double>(), calibration_.speed);
    settle();
    move_to(joints, calibration_.speed / kSlow);
    settle();
    const int ticks = std::max(2, ticks_in(calibration_.recording));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
    for (int i = 0; i < ticks; ++i) {
      const Eigen::Vector3d torque = step(at_);
      sum += torque;
      squares += torque.cwiseAbs2();
    }
    HeldPose pose;
    pose.joints = state_.joints;
    pose.torque = sum / ticks;
    pose.deviation =
        std::sqrt(std::max((squares / ticks - pose.torque.cwiseAbs2()).maxCoeff(), 0.0));
    pose.direction = direction;
    return pose;
  }

 private:
  [[nodiscard]] int ticks_in(double seconds) const {
    return static_cast<int>(std::ceil(seconds / arm_.description().period));
  }

  void read() {
    if (!arm_.read(state_)) {
      throw DeviceError(arm_.description().name + ": stopped while gravity was measured");
    }
  }

  /// [N mm] that the motors were commanded.
  Eigen::Vector3d step(const Eigen::Vector3d& target) {
    const double period = arm_.description().period;
    Eigen::Vector3d torque =
        controller_.step(state_.joints, target, (target - target_) / period, period);
    target_ = target;
    const Eigen::Matrix3d jacobian = arm_jacobian(calibration_.geometry, state_.joints);
    if (!arm_.write({.force = jacobian.transpose().inverse() * torque})) {
      throw DeviceError(arm_.description().name + ": stopped while gravity was measured");
    }
    read();
    return torque;
  }

  devices::Device& arm_;
  const GravityCalibration& calibration_;
  JointController controller_;
  devices::DeviceState state_;
  Eigen::Vector3d at_;      // where the arm was moved to
  Eigen::Vector3d target_;  // of the latest step
};

}  // namespace

std::vector<HeldPose> hold_poses(devices::Device& arm, const GravityCalibration& calibration) {
  require("GravityCalibration::angles", calibration.angles, at_least(3));
  require("GravityCalibration::speed", calibration.speed, above(0).finite(), "rad/s");
  require("GravityCalibration::settling", calibration.settling, at_least(0).finite(), "s");
  require("GravityCalibration::recording", calibration.recording, above(0).finite(), "s");
  require("GravityCalibration::high - low", (calibration.high - calibration.low).minCoeff(),
          above(0).finite(), "rad");
  if (!arm.description().measures_joints) {
    throw DeviceError(arm.description().name +
                      ": does not measure its joints, so gravity cannot be compensated");
  }
  PoseHolder holder(arm, calibration);
  std::vector<HeldPose> poses;
  const Eigen::Vector3d middle = (calibration.low + calibration.high) / 2;
  const auto sweep = [&](Eigen::Vector3d joints, int joint) {
    const double step =
        (calibration.high[joint] - calibration.low[joint]) / (calibration.angles - 1);
    const auto visit = [&](int i, int direction) {
      joints[joint] = calibration.low[joint] + step * i;
      poses.push_back(holder.hold(joints, direction * Eigen::Vector3i::Unit(joint)));
    };
    joints[joint] = calibration.low[joint] - step;  // so that the first angle is reached upwards
    holder.move_to(joints, calibration.speed);
    for (int i = 0; i < calibration.angles; ++i) visit(i, 1);
    joints[joint] = calibration.high[joint] + step;
    holder.move_to(joints, calibration.speed);
    for (int i = calibration.angles - 1; i >= 0; --i) visit(i, -1);
  };
  sweep(middle, 0);
  for (const double turn : {middle[0], calibration.low[0], calibration.high[0]}) {
    for (const int joint : {1, 2}) {
      Eigen::Vector3d joints = middle;
      joints[0] = turn;
      sweep(joints, joint);
    }
  }
  return poses;
}

}  // namespace palpate::probing
