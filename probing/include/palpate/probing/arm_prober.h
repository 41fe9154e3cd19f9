// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/devices/device.h"
#include "palpate/devices/safe_device.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/approach_signal.h"
#include "palpate/probing/contact_detection.h"
#include "palpate/probing/force_compensation.h"
#include "palpate/probing/gravity_calibration.h"
#include "palpate/probing/prober.h"

namespace palpate::probing {

/// A fault, or an emergency stop, ended what an arm did. Its motors are off.
struct ArmStopped : DeviceError {
  ArmStopped(const std::string& message, devices::DeviceFault reason)
      : DeviceError(message), fault(reason) {}
  devices::DeviceFault fault;
};

/// A part of the force, besides gravity, which is added so that the friction of the joints does not
/// change it.
enum class FrictionCompensation {
  none,     ///< nothing
  held,     ///< the force that the joints needed in free space before the touch (thesis 4.4.3.2)
  followed  ///< the same at first, then reversed as each joint turns, by its encoder
};

/// Options for moving an arm and pressing with it. Defaults suit a PHANToM and `VirtualArm`.
struct ArmProberOptions {
  ArmGeometry geometry;
  Eigen::Isometry3d T_world_base = Eigen::Isometry3d::Identity();
  GravityCalibration calibration;  ///< its geometry and gains are those of this struct
  JointGains gains;
  devices::SafetyLimits limits;
  ContactOptions contact;
  /// [N/mm] between the encoders and the tip; > 0. Its deflection is subtracted from each position.
  double structure = 3.5;
  double travel_speed = 60;    ///< [mm/s] in free space; > 0
  double start_distance = 4;   ///< [mm] before the surface, where internal forces are measured; > 0
  double beyond = 8;           ///< [mm] behind the surface an approach ends without a touch; > 0
  double push = 0.2;           ///< [N] of an approach; > 0
  double approach_speed = 15;  ///< [mm/s] in free space; > 0
  double free_settling = 0.6;  ///< [s] before internal forces are measured; >= 0
  double measuring = 0.3;      ///< [s] of this measurement; >= 0.1
  double hunting = 0.01;       ///< [N] standard deviation of an internal force that is refused; > 0
  int attempts = 3;            ///< at an approach whose joints hunt or whose signal is faulty; > 0
  double ramp = 2;             ///< [N/s] by which forces grow; > 0
  double damping = 0.015;      ///< [N s/mm] of the pressed tip; >= 0
  FrictionCompensation friction = FrictionCompensation::followed;  ///< others are for comparison
  /// [rad] motion in which the friction of a joint reverses; > 0
  double presliding = 2.5e-4;
  /// Friction of a joint that moves, relative to what it keeps when it is held; >= 1. A held joint
  /// relaxes a little, a tip that creeps to rest does not.
  double sliding_friction = 1.15;
  /// [N mm] Once the tip rests, the torque of each joint oscillates with this amplitude while
  /// position and force are measured; 0: it does not; >= 0. The joints move by about half a step of
  /// their encoders, so that the mean over the window shows where within a step they stand, and how
  /// far their friction has turned. Their friction springs take nearly all of it off the tip.
  double dither = 5;
  double dither_frequency = 12;  ///< [Hz] > 0; best whole periods in `resting_window`
  double resting_window = 0.5;   ///< [s] of the line and the mean by which a tip rests; > 0
  double settled_speed = 0.01;   ///< [mm/s] of this line; > 0
  double longest_slide = 10;     ///< [mm] that a tip may go once its force is constant; > 0
  double heating_time = 20;      ///< [s] with which motors warm up and cool; > 0
  double expected_load = 6;      ///< [s] for which they must stand the coming force; >= 0
  double warm = 0.85;            ///< heat at which an action is given up; in (0, limits.hottest)
};

/// An approach that found the object.
struct ArmApproach {
  std::vector<ApproachSample> samples;  ///< up to where the touch was certain
  ContactEstimate found;
};

/// A force that rested on the object, in the frame of the base.
struct AppliedForce {
  long long trial = 0;
  ProbeActionKind kind{};     ///< press, drag or release
  Eigen::Vector3d commanded;  ///< [N]
  Eigen::Vector3d internal;   ///< [N] that was added against internal forces, besides gravity
  Eigen::Vector3d reference;  ///< [N] mean of `DeviceState::reference_force` meanwhile
};

/// Performs the actions of a campaign on an arm, through a `SafeDevice` (thesis 4.4).
///
/// Travel and lift are joint control along straight lines; travel then waits until the motors are
/// cool enough for the coming force. A touch comes along the coming force, stops in free space to
/// measure the internal force, and approaches until `ContactDetector` finds the object; its place
/// is that of `estimate_contact`. Press, drag and release turn the force on a ramp, and wait until
/// a line through the latest positions is level; their position is the mean over it, without the
/// deflection of the arm. The internal force is that of the touch, with the friction of a joint,
/// known from the calibration, turned round when the joint turns. Encoders show this in steps; an
/// oscillation at rest shows what is between them (docs/probing.md, "What limits the force").
///
/// A trial begins with motors switched off and on again in free space, so that it does not depend
/// on the control loop of those before it. An arm whose clock is real is held by a thread between
/// trials.
class ArmProber final : public Prober {
 public:
  /// `arm` and `emergency_stop`, which may be null, must outlive the prober.
  /// \param gravity of an earlier calibration; otherwise call `calibrate` first.
  /// \throws InvalidInput if an option is outside its range.
  /// \throws DeviceError if the arm does not measure its joints.
  ArmProber(devices::Device& arm, const ArmProberOptions& options,
            const devices::EmergencyStop* emergency_stop = nullptr,
            const std::optional<GravityModel>& gravity = std::nullopt);
  ~ArmProber() override;

  /// Measures gravity by `hold_poses`, in free space.
  /// \throws ArmStopped, or InvalidInput of `fit_gravity`.
  void calibrate();
  [[nodiscard]] const std::optional<GravityModel>& gravity() const;
  /// Of `calibrate`; empty before.
  [[nodiscard]] const std::vector<HeldPose>& held_poses() const;
  /// The latest one; none before.
  [[nodiscard]] const std::optional<ArmApproach>& approach() const;
  /// Each press, drag and release that came to rest, if the arm measures a reference force.
  [[nodiscard]] const std::vector<AppliedForce>& applied_forces() const;

  /// \throws ArmStopped naming the fault: nothing of the interval is then a measurement. The next
  /// trial clears it.
  /// \throws InvalidInput if gravity is not known.
  [[nodiscard]] ProbeReport perform(const ProbeAction& action) override;

  [[nodiscard]] const devices::SafeDevice& arm() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::probing
