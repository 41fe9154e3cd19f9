// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// The properties and abilities of an arm.
struct ArmDescription {
  std::string name;
  double period = 1e-3;             ///< [s] between two states
  double highest_force = 0;         ///< [N] that the arm can apply at its tip for a moment
  double continuous_force = 0;      ///< [N] that it can hold continuously
  bool measures_joints = false;     ///< `ArmState::joints`
  bool measures_force = false;      ///< `ArmState::delivered_force`
  bool measures_heat = false;       ///< `ArmState::heat`
  bool measures_reference = false;  ///< `ArmState::reference_force`
  bool real_time = true;            ///< its clock runs while nobody reads; not in simulations
  // Values that playback also uses. 0: not known, or none.
  double highest_torque = 0;   ///< [N mm] at the tip
  double damping = 0;          ///< [N s/mm] that the device alone has at least
  double friction = 0;         ///< [N] of dry (Coulomb) friction that it has at least
  double resolution = 0;       ///< [mm] between two positions that are told apart
  double delay = 0;            ///< [s] from a measurement until the force that answers it begins
  double workspace_scale = 1;  ///< [mm/mm] of the object for one of the device
  std::uint32_t clutch_buttons = 0;   ///< bits of `ArmState::buttons` that clutch
  bool measures_velocity = false;     ///< `ArmState::velocity`
  bool measures_orientation = false;  ///< `ArmState::orientation`
  bool reports_armed = false;         ///< `ArmState::armed` may be false
};

/// An arm at one moment, in the frame of its base. Values that the arm does not measure are NaN.
struct ArmState {
  double time = 0;                                ///< [s] of the measurement, on the arm's clock
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  ///< [mm] by the encoders: without flexure
  Eigen::Vector3d joints = Eigen::Vector3d::Constant(kNotMeasured);  ///< [rad]
  /// [N] at the tip that the motors deliver, by their currents.
  Eigen::Vector3d delivered_force = Eigen::Vector3d::Constant(kNotMeasured);
  /// Heat of each motor, relative to that at which it must rest.
  Eigen::Vector3d heat = Eigen::Vector3d::Constant(kNotMeasured);
  /// [N] On the object, by a sensor of its own, as the thesis assesses its arm (4.4.3). It judges
  /// the arm: nothing that is commanded or measured depends on it.
  Eigen::Vector3d reference_force = Eigen::Vector3d::Constant(kNotMeasured);
  Eigen::Vector3d velocity = Eigen::Vector3d::Constant(kNotMeasured);  ///< [mm/s] of the tip
  /// Unit quaternion w, x, y, z of the handle.
  Eigen::Vector4d orientation = Eigen::Vector4d::Constant(kNotMeasured);
  std::uint32_t buttons = 0;  ///< bits of those that are pressed
  bool armed = true;          ///< false: no force is felt until the user takes the device again
  /// The user moves the hand back; the tool shall stand still. Also while one of
  /// `ArmDescription::clutch_buttons` is pressed.
  bool clutched = false;

  static constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
};

/// A command to the motors, in the frame of the base.
struct ArmCommand {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] of the motors at the tip
  double lease = 0.01;  ///< [s] after which the arm drops the force unless it is commanded again
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N mm] at the tip
};

/// An arm whose motors are commanded by the force at its tip (thesis 4.4): one that probes, or a
/// device that a hand holds.
///
/// One thread calls `read`, computes, and calls `write`, once in each period. These two and `stop`
/// are real-time safe in all arms of the library but simulated ones, whose object may allocate.
class Arm {
 public:
  virtual ~Arm() = default;

  [[nodiscard]] virtual const ArmDescription& description() const noexcept = 0;
  /// [s] The clock of `ArmState::time`, now: that of the host, or of a simulation.
  [[nodiscard]] virtual double now() const noexcept = 0;
  /// Arms the arm: switches the motors on, with no force; also while they are on.
  /// \throws DeviceError if that fails.
  virtual void activate() = 0;
  /// The trial that begins, before `activate`: a record can be replayed from there.
  virtual void begin_trial(long long /*trial*/) noexcept {}
  /// Waits for the next state. False if the arm does not answer; `state` is then unchanged.
  [[nodiscard]] virtual bool read(ArmState& state) noexcept = 0;
  /// False if the arm does not take the command.
  [[nodiscard]] virtual bool write(const ArmCommand& command) noexcept = 0;
  /// Switches the motors off. May be called at any time and more than once.
  virtual void stop() noexcept = 0;
  /// The arm's own words about its latest failure; empty if it has none. Not for the loop.
  [[nodiscard]] virtual std::string last_error() const { return {}; }
};

}  // namespace palpate::probing
