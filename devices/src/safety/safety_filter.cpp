// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/safety_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace palpate::devices {
namespace {

constexpr std::array<std::string_view, kSafetyActions> kSafetyWords = {
    "ramped", "clamped", "slewed",    "force not finite", "state not finite",
    "stale",  "late",    "no answer", "disarmed",         "heated"};
static_assert(1U << (kSafetyActions - 1) == static_cast<std::uint32_t>(SafetyAction::heated));

/// Heat above which the force is brought down, relative to that of the continuous force.
constexpr double kHot = 0.9;

constexpr std::uint32_t bit(SafetyAction action) { return static_cast<std::uint32_t>(action); }

/// The point of the segment from zero to `last` that is nearest to `wanted`: as far as a force may
/// change at once, since it only becomes less.
Eigen::Vector3d released(const Eigen::Vector3d& last, const Eigen::Vector3d& wanted) noexcept {
  const double square = last.squaredNorm();
  if (square == 0) return last;
  return std::clamp(wanted.dot(last) / square, 0.0, 1.0) * last;
}

Eigen::Vector3d shortened(const Eigen::Vector3d& vector, double longest) noexcept {
  const double length = std::hypot(vector.x(), vector.y(), vector.z());
  return length > longest ? Eigen::Vector3d(vector * (longest / length)) : vector;
}

}  // namespace

std::span<const std::string_view, kSafetyActions> safety_words() noexcept { return kSafetyWords; }

std::string to_words(std::uint32_t actions) {
  std::string words;
  for (std::size_t i = 0; i < kSafetyActions; ++i) {
    if ((actions >> i & 1U) == 0) continue;
    if (!words.empty()) words += ", ";
    words += kSafetyWords[i];
  }
  return words;
}

void visit(SafetyOptions& options, FieldVisitor& visitor) {
  constexpr double kShortestHeating = 0.1, kLongestLease = 0.1;  // [s]
  visitor.begin("SafetyOptions");
  visitor.real(
      {"max_force", "Largest force; larger ones are reduced to it, or to the largest of the device",
       "N"},
      options.max_force, above(0).finite());
  visitor.real({"slew", "Largest growth of a force", "N/s"}, options.slew, above(0).finite());
  visitor.real({"ramp", "Time in which the force grows after a start, a fault or a clutch", "s"},
               options.ramp, above(0).finite());
  visitor.real({"heating_time",
                "Time constant of the motors' heat, which limits how long a force is above the "
                "continuous one",
                "s"},
               options.heating_time, at_least(kShortestHeating).finite());
  constexpr bool kExpert = true;
  visitor.real({"continuous_force",
                "Force that the device can hold without limit of time, if it declares none, or a "
                "larger one",
                "N", kExpert},
               options.continuous_force, above(0));
  visitor.real({"max_torque",
                "Largest torque; larger ones are reduced to it, or to the largest of the device",
                "N mm", kExpert},
               options.max_torque, above(0).finite());
  visitor.real({"crossfade", "Time from the last force to that of another model", "s", kExpert},
               options.crossfade, above(0).finite());
  visitor.real({"oldest_state",
                "Longest time since a measurement of the device; with an older one, and one from "
                "the future, the force is zero",
                "s", kExpert},
               options.oldest_state, above(0).finite());
  visitor.real({"lease",
                "Time for which a command holds; a loop that comes back later has stalled, and the "
                "force is zero",
                "s", kExpert},
               options.lease, above(0).at_most(kLongestLease));
}

SafetyFilter::SafetyFilter(const SafetyOptions& options) : options_(in_range(options)) {}

std::uint32_t SafetyFilter::fault(const SafetyInput& input) const noexcept {
  if (!input.answered) return bit(SafetyAction::no_answer);
  if (!input.finite) return bit(SafetyAction::state_not_finite);
  // Written so that a time that is NaN is a fault too.
  // A time in the future comes of another clock, and says nothing of the state's age.
  if (!(std::abs(input.now - input.state_time) <= options_.oldest_state)) {
    return bit(SafetyAction::stale);
  }
  if (any_ && !(input.now - last_now_ <= options_.lease)) return bit(SafetyAction::late);
  if (!input.armed) return bit(SafetyAction::disarmed);
  if (!input.force.allFinite() || !input.torque.allFinite()) {
    return bit(SafetyAction::force_not_finite);
  }
  return 0;
}

// A ramp that has begun does not end earlier if another one begins.
void SafetyFilter::begin_ramp(double now, double length, const Eigen::Vector3d& from) noexcept {
  const double left = std::min(ramp_begin_ + ramp_length_ - now, ramp_length_);
  ramp_begin_ = now;
  ramp_length_ = std::max(length, left);
  ramp_from_ = from;
}

// By the force that was sent last, which acted until now at the longest.
void SafetyFilter::heat_up(double period) noexcept {
  const double heating = force_.squaredNorm() / std::pow(options_.continuous_force, 2);
  const double kept = period > 0 ? std::exp(-period / options_.heating_time) : 1;
  heat_ = heating + kept * (heat_ - heating);
}

// [N] As much above the continuous force as the heat is below that of it.
double SafetyFilter::longest_force() const noexcept {
  if (options_.continuous_force >= options_.max_force) return options_.max_force;
  const double cool = std::clamp((1 - heat_) / (1 - kHot), 0.0, 1.0);
  return options_.continuous_force + cool * (options_.max_force - options_.continuous_force);
}

SafeCommand SafetyFilter::filter(const SafetyInput& input) noexcept {
  const std::uint32_t wrong = fault(input);
  const double period = any_ ? input.now - last_now_ : 0;
  any_ = true;
  last_now_ = input.now;
  heat_up(period);
  if (wrong != 0) {
    was_faulty_ = true;
    force_.setZero();
    return {.actions = wrong};
  }
  if (was_faulty_ || input.restart) {
    begin_ramp(input.now, options_.ramp, Eigen::Vector3d::Zero());
  } else if (input.crossfade) {
    begin_ramp(input.now, options_.crossfade, force_);
  }
  was_faulty_ = false;

  SafeCommand command{.force = input.force, .torque = input.torque};
  const double share = std::clamp((input.now - ramp_begin_) / ramp_length_, 0.0, 1.0);
  if (share < 1) {
    command.force = (1 - share) * ramp_from_ + share * command.force;
    command.torque *= share;
    command.actions |= bit(SafetyAction::ramped);
  }
  Eigen::Vector3d allowed = shortened(command.force, options_.max_force);
  if (allowed != command.force) command.actions |= bit(SafetyAction::clamped);
  const double longest = longest_force();
  if (longest < options_.max_force && allowed.norm() > longest) {
    allowed = shortened(allowed, longest);
    command.actions |= bit(SafetyAction::heated);
  }
  const Eigen::Vector3d begin = released(force_, allowed);
  // The segment from `begin` to `allowed` lies within the clamp: both ends do.
  command.force = begin + shortened(allowed - begin, options_.slew * std::max(period, 0.0));
  constexpr double kRounding = 1e-12;  // of the greatest force
  if ((command.force - allowed).norm() > kRounding * options_.max_force) {
    command.actions |= bit(SafetyAction::slewed);
  }
  command.torque = shortened(command.torque, options_.max_torque);
  force_ = command.force;
  return command;
}

void SafetyFilter::check_age(double age, SafeCommand& command) noexcept {
  if (age <= options_.lease) return;
  command.force.setZero();
  command.torque.setZero();
  command.actions = bit(SafetyAction::late);
  force_.setZero();
  was_faulty_ = true;
}

}  // namespace palpate::devices
