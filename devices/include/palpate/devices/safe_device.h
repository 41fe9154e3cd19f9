// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "palpate/devices/device.h"
#include "palpate/geometry/eigen_alignment.h"

namespace palpate::devices {

/// The reason why a device was stopped.
enum class DeviceFault {
  none,
  no_answer,            ///< the device does not answer, or takes no command
  state_not_finite,     ///< a position or a time is NaN or infinite
  state_too_old,        ///< the state is older than `SafetyLimits::oldest_state`
  late,                 ///< the loop came back later than the lease
  frozen,               ///< the encoders stand still although the device cannot
  jump,                 ///< the position changed faster than the device can move
  too_fast,             ///< faster than `SafetyLimits::speed` by the margin
  outside_workspace,    ///< by the margin
  too_deep,             ///< by the margin
  force_not_delivered,  ///< the motors deliver another force than commanded
  force_exactly_zero,   ///< the force measurement is dead
  too_hot,              ///< a motor must rest
  command_not_finite,   ///< the program commanded NaN or infinity
  emergency_stop,       ///< pressed by a key, a file or a signal
};

/// "position jumps", "loop late" and so on.
[[nodiscard]] std::string_view to_string(DeviceFault fault) noexcept;

/// The limits of a safe device. Between a limit and its margin the outward force is removed; beyond
/// the margin the device is stopped.
struct SafetyLimits {
  double max_force = 3.3;  ///< [N] of a command, longer ones are shortened; > 0
  /// [N/s] by which a command may grow or turn; > 0. Less than in `SafetyOptions`: programs ramp
  /// their forces, hands meet stiff surfaces.
  double slew = 400;
  double speed = 300;         ///< [mm/s] > 0
  double speed_margin = 200;  ///< [mm/s] > 0
  Eigen::AlignedBox3d workspace{Eigen::Vector3d::Constant(-1e3), Eigen::Vector3d::Constant(1e3)};
  double margin = 5;                  ///< [mm] of workspace and depth; > 0
  double depth = 40;                  ///< [mm] behind the plane of `SafeDevice::limit_depth`; > 0
  double oldest_state = 0.02;         ///< [s] > 0
  double lease = 0.01;                ///< [s] of each command; > 0
  double highest_acceleration = 5e4;  ///< [mm/s^2] of the tip; > 0
  double quantum = 0.03;              ///< [mm] step between two positions that encoders tell apart
  double longest_standstill = 0.1;    ///< [s] without any motion while the force changes by ...
  double standstill_force = 0.5;      ///< [N] ... more than this; > 0
  double force_tolerance = 0.15;      ///< [N] of the delivered force, and ...
  double force_relative = 0.05;       ///< ... relative to the command
  double hottest = 0.95;              ///< stopped if the heat of a motor is more; in (0, 1)
  double cool = 0.5;                  ///< resumed only below this heat; in (0, hottest)
};

/// An emergency stop that stays pressed until it is released. Pressing is safe in any thread and in
/// signal handlers.
class EmergencyStop {
 public:
  /// \param file pressed within 5 ms of the moment at which this file exists.
  explicit EmergencyStop(const std::optional<std::filesystem::path>& file = std::nullopt);
  ~EmergencyStop();
  EmergencyStop(const EmergencyStop&) = delete;
  EmergencyStop& operator=(const EmergencyStop&) = delete;

  void press() noexcept { pressed_.store(true, std::memory_order_relaxed); }
  void release() noexcept { pressed_.store(false, std::memory_order_relaxed); }
  [[nodiscard]] bool pressed() const noexcept { return pressed_.load(std::memory_order_relaxed); }

  /// SIGINT and SIGTERM press this stop, until it is destroyed. One at a time in a process.
  void press_on_signals();

 private:
  std::atomic<bool> pressed_{false};
  std::atomic<bool> done_{false};
  std::thread watcher_;
  bool handles_signals_ = false;
};

/// Keeps a device within its limits while a program moves it: every arm of a campaign is used
/// through one. A device that a hand holds is kept safe by `SafetyFilter`, which gives back the
/// force when a fault is over.
///
/// After a fault the force is zero from the next `write` on and the motors are switched off; the
/// fault stays until `activate`. `read` and `write` then still work, so that the loop continues.
class SafeDevice final : public Device {
 public:
  /// Both must outlive the safe device; `emergency_stop` may be null.
  /// \throws InvalidInput on a limit outside its range.
  SafeDevice(Device& device, const SafetyLimits& limits = {},
             const EmergencyStop* emergency_stop = nullptr);
  ~SafeDevice() override;

  [[nodiscard]] const DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  /// Also clears a fault. \throws DeviceError naming the reason if it still exists: an emergency
  /// stop that is pressed, or motors above `cool`.
  void activate() override;
  /// False after a fault: the state must not be used for a measurement.
  [[nodiscard]] bool read(DeviceState& state) noexcept override;
  /// False after a fault: no force is applied.
  [[nodiscard]] bool write(const DeviceCommand& command) noexcept override;
  void begin_trial(long long trial) noexcept override { device_.begin_trial(trial); }
  void stop() noexcept override;
  [[nodiscard]] std::string last_error() const override { return device_.last_error(); }

  [[nodiscard]] DeviceFault fault() const noexcept { return fault_; }
  /// [s] when the fault was noticed, on the device's clock.
  [[nodiscard]] double fault_time() const noexcept { return fault_time_; }

  /// The tip may go `SafetyLimits::depth` behind this plane.
  /// \param inwards unit vector into the object, in the base's frame.
  void limit_depth(const Eigen::Vector3d& place, const Eigen::Vector3d& inwards) noexcept;
  /// Until the next call of `limit_depth` there is no such plane.
  void forget_depth() noexcept { plane_.reset(); }

 private:
  void raise(DeviceFault fault) noexcept;
  [[nodiscard]] DeviceFault check_state(const DeviceState& state) noexcept;
  [[nodiscard]] DeviceFault check_motion(const DeviceState& state) noexcept;
  [[nodiscard]] DeviceFault check_force(const DeviceState& state) noexcept;
  [[nodiscard]] Eigen::Vector3d limited(const Eigen::Vector3d& force) const noexcept;
  void forget() noexcept;

  Device& device_;
  SafetyLimits limits_;
  const EmergencyStop* emergency_stop_;
  DeviceFault fault_ = DeviceFault::none;
  double fault_time_ = 0;
  bool hot_ = false;
  std::optional<Eigen::Hyperplane<double, 3>> plane_;

  bool any_state_ = false;
  DeviceState last_;                                    // the latest that moved, or rested
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();  // [mm/s] smoothed
  int still_ = 0;                                       // states without any motion
  double still_since_ = 0;
  Eigen::Vector3d still_force_ = Eigen::Vector3d::Zero();
  double last_loop_ = 0;                                     // [s] time of the latest read
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();          // [N] that was commanded last
  Eigen::Vector3d earlier_force_ = Eigen::Vector3d::Zero();  // and before
  int wrong_force_ = 0, zero_force_ = 0;                     // states in succession
};

}  // namespace palpate::devices
