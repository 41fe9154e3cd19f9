// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::devices {

/// The properties and abilities of a device.
struct DeviceDescription {
  std::string name;
  double period = 1e-3;             ///< [s] between two states
  double highest_force = 0;         ///< [N] that the device can apply at its tip for a moment
  double continuous_force = 0;      ///< [N] that it can hold continuously
  bool measures_joints = false;     ///< `DeviceState::joints`
  bool measures_force = false;      ///< `DeviceState::delivered_force`
  bool measures_heat = false;       ///< `DeviceState::heat`
  bool measures_reference = false;  ///< `DeviceState::reference_force`
  bool real_time = true;            ///< its clock runs while nobody reads; not in simulations
  // Values that playback also uses. 0: not known, or none.
  double highest_torque = 0;   ///< [N mm] at the tip
  double damping = 0;          ///< [N s/mm] that the device alone has at least
  double friction = 0;         ///< [N] of dry (Coulomb) friction that it has at least
  double resolution = 0;       ///< [mm] between two positions that are told apart
  double delay = 0;            ///< [s] from a measurement until the force that answers it begins
  double workspace_scale = 1;  ///< [mm/mm] of the object for one of the device
  std::uint32_t clutch_buttons = 0;   ///< bits of `DeviceState::buttons` that clutch
  bool measures_velocity = false;     ///< `DeviceState::velocity`
  bool measures_orientation = false;  ///< `DeviceState::orientation`
  bool reports_armed = false;         ///< `DeviceState::armed` may be false
};

/// A device at one moment, in the frame of its base. Values that it does not measure are NaN.
struct DeviceState {
  double time = 0;                                ///< [s] of the measurement, on the device's clock
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  ///< [mm] by the encoders: without flexure
  Eigen::Vector3d joints = Eigen::Vector3d::Constant(kNotMeasured);  ///< [rad]
  /// [N] at the tip that the motors deliver, by their currents.
  Eigen::Vector3d delivered_force = Eigen::Vector3d::Constant(kNotMeasured);
  /// Heat of each motor, relative to that at which it must rest.
  Eigen::Vector3d heat = Eigen::Vector3d::Constant(kNotMeasured);
  /// [N] On the object, by a sensor of its own, as the thesis assesses its arm (4.4.3). It judges
  /// the device: nothing that is commanded or measured depends on it.
  Eigen::Vector3d reference_force = Eigen::Vector3d::Constant(kNotMeasured);
  Eigen::Vector3d velocity = Eigen::Vector3d::Constant(kNotMeasured);  ///< [mm/s] of the tip
  /// Unit quaternion w, x, y, z of the handle.
  Eigen::Vector4d orientation = Eigen::Vector4d::Constant(kNotMeasured);
  std::uint32_t buttons = 0;  ///< bits of those that are pressed
  bool armed = true;          ///< false: no force is felt until the user takes the device again
  /// The user moves the hand back; the tool shall stand still. Also while one of
  /// `DeviceDescription::clutch_buttons` is pressed.
  bool clutched = false;

  static constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
};

/// A command to the motors, in the frame of the base.
struct DeviceCommand {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] of the motors at the tip
  double lease = 0.01;  ///< [s] after which the device drops the force unless it is commanded again
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N mm] at the tip
};

/// A device whose motors are commanded by the force at its tip (thesis 4.4): an arm that probes, or
/// a haptic device that a hand holds.
///
/// One thread calls `read`, computes, and calls `write`, once in each period. These two and `stop`
/// are real-time safe in all devices of the library but simulated ones, whose object may allocate.
class Device {
 public:
  virtual ~Device() = default;

  [[nodiscard]] virtual const DeviceDescription& description() const noexcept = 0;
  /// [s] The clock of `DeviceState::time`, now: that of the host, or of a simulation.
  [[nodiscard]] virtual double now() const noexcept = 0;
  /// Arms the device: switches the motors on, with no force; also while they are on.
  /// \throws DeviceError if that fails.
  virtual void activate() = 0;
  /// The trial that begins, before `activate`: a record can be replayed from there.
  virtual void begin_trial(long long /*trial*/) noexcept {}
  /// Waits for the next state. False if the device does not answer; `state` is then unchanged.
  [[nodiscard]] virtual bool read(DeviceState& state) noexcept = 0;
  /// False if the device does not take the command.
  [[nodiscard]] virtual bool write(const DeviceCommand& command) noexcept = 0;
  /// Switches the motors off. May be called at any time and more than once.
  virtual void stop() noexcept = 0;
  /// The device's own words about its latest failure; empty if it has none. Not for the loop.
  [[nodiscard]] virtual std::string last_error() const { return {}; }
};

}  // namespace palpate::devices
