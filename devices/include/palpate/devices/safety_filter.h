// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"

namespace palpate::devices {

/// The actions of a safety filter on a force, as bits.
enum class SafetyAction : std::uint32_t {
  ramped = 1,             ///< reduced: the ramp after a start is not over
  clamped = 2,            ///< longer than allowed
  slewed = 4,             ///< it grew too fast
  force_not_finite = 8,   ///< zero: the force was NaN or infinite
  state_not_finite = 16,  ///< zero: the device said NaN or infinity
  stale = 32,             ///< zero: the state is too old, or its time in the future
  late = 64,              ///< zero: the loop stalled
  no_answer = 128,        ///< zero: the device gave no state
  disarmed = 256,         ///< zero: the user does not hold the device
  heated = 512,           ///< reduced: the motors are near the heat of the continuous force
};
constexpr std::size_t kSafetyActions = 10;

/// A word for each bit, from the lowest: "ramped", "force not finite" and so on.
[[nodiscard]] std::span<const std::string_view, kSafetyActions> safety_words() noexcept;
/// "ramped, slewed" and so on; empty for none.
[[nodiscard]] std::string to_words(std::uint32_t actions);

/// The meaning, unit and range of each field stand in its list, `visit`.
struct SafetyOptions {
  double max_force = 3.3;
  double slew = 1000;
  double ramp = 0.5;
  double heating_time = 10;
  /// A longer force heats the device, as a first-order system: `heating_time` h' =
  /// (|f| / continuous_force)^2 - h, cold (h = 0) at the start. As h goes from 0.9 to 1, the force
  /// is reduced to the continuous one.
  double continuous_force = std::numeric_limits<double>::infinity();
  double max_torque = 100;
  double crossfade = 0.05;
  double oldest_state = 0.02;
  double lease = 0.01;
};

void visit(SafetyOptions& options, FieldVisitor& visitor);

/// The input of a safety filter in one tick. Times are on the device's clock.
struct SafetyInput {
  double now = 0;          ///< [s]
  double state_time = 0;   ///< [s] of the measurement
  bool answered = true;    ///< the device gave a state
  bool finite = true;      ///< its position and time
  bool armed = true;       ///< the user holds the device
  bool restart = false;    ///< the force starts again from zero, as after a clutch
  bool crossfade = false;  ///< it changes for another reason than the tool's motion
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N] wanted
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N mm] wanted
};

struct SafeCommand {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N mm]
  std::uint32_t actions = 0;                         ///< bits of `SafetyAction`
};

/// Stands between playback and every device. After a fault the force is zero in the same tick, and
/// starts again with the ramp when the fault is over. A value: equal inputs give equal commands.
class SafetyFilter {
 public:
  /// \throws InvalidInput on an option outside its range.
  explicit SafetyFilter(const SafetyOptions& options = {});

  /// Call once a tick. Real-time safe.
  [[nodiscard]] SafeCommand filter(const SafetyInput& input) noexcept;
  /// For a command that was computed for longer than `lease`: [s] since `filter`.
  void check_age(double age, SafeCommand& command) noexcept;

 private:
  [[nodiscard]] std::uint32_t fault(const SafetyInput& input) const noexcept;
  [[nodiscard]] double longest_force() const noexcept;
  void heat_up(double period) noexcept;
  void begin_ramp(double now, double length, const Eigen::Vector3d& from) noexcept;

  SafetyOptions options_;
  bool any_ = false;  // a tick came before
  bool was_faulty_ = true;
  double last_now_ = 0;                                  // [s]
  double ramp_begin_ = 0, ramp_length_ = 0;              // [s]
  Eigen::Vector3d ramp_from_ = Eigen::Vector3d::Zero();  // [N]
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();      // [N] that was sent last
  double heat_ = 0;  // of the motors, relative to that of the continuous force
};

}  // namespace palpate::devices
