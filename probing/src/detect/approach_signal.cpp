// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/approach_signal.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/require.h"

namespace palpate::probing {

std::string_view to_string(SignalFault fault) noexcept {
  switch (fault) {
    case SignalFault::none:
      return "none";
    case SignalFault::not_finite:
      return "sample not finite";
    case SignalFault::time_backwards:
      return "time does not increase";
    case SignalFault::gap:
      return "samples missing";
    case SignalFault::jump:
      return "position jumps";
    case SignalFault::frozen:
      return "position frozen";
    case SignalFault::chatter:
      return "position chatters";
    case SignalFault::too_long:
      return "no contact within the longest approach";
  }
  return "unknown";
}

SignalCheck::SignalCheck(const SignalOptions& options) : options_(options) {
  require("SignalOptions::quantum", options.quantum, above(0).finite(), "mm");
  require("SignalOptions::longest_gap", options.longest_gap, above(0), "s");
  require("SignalOptions::highest_speed", options.highest_speed, above(0), "mm/s");
  require("SignalOptions::longest_rest", options.longest_rest, above(0), "s");
  require("SignalOptions::chatter_distance", options.chatter_distance, at_least(1));
  require("SignalOptions::chatter_runs", options.chatter_runs,
          at_least(1).at_most(static_cast<double>(runs_.size())));
  require("SignalOptions::chatter_time", options.chatter_time, above(0), "s");
}

SignalFault SignalCheck::check(const ApproachSample& sample) noexcept {
  if (fault_ == SignalFault::none) {
    fault_ = find(sample);
    last_ = sample;
    any_ = true;
  }
  return fault_;
}

SignalFault SignalCheck::find(const ApproachSample& sample) noexcept {
  constexpr double kJumpQuanta = 4;  // explained by quantisation and the noise of a time stamp
  if (!std::isfinite(sample.time) || !std::isfinite(sample.position) ||
      !std::isfinite(sample.force)) {
    return SignalFault::not_finite;
  }
  if (!any_) {
    rest_since_ = sample.time;
    turn_ = sample.position;
    return SignalFault::none;
  }
  const double period = sample.time - last_.time;
  if (period <= 0) return SignalFault::time_backwards;
  if (period > options_.longest_gap) return SignalFault::gap;
  const double step = std::abs(sample.position - last_.position);
  if (step > options_.highest_speed * period + kJumpQuanta * options_.quantum) {
    return SignalFault::jump;
  }
  if (step > 0) rest_since_ = sample.time;
  if (sample.time - rest_since_ > options_.longest_rest) return SignalFault::frozen;

  const double run = options_.chatter_distance * options_.quantum;
  if (back_) {
    turn_ = std::min(turn_, sample.position);
    if (sample.position > turn_ + run) {
      back_ = false;
      turn_ = sample.position;
    }
  } else {
    turn_ = std::max(turn_, sample.position);
    if (sample.position < turn_ - run) {
      back_ = true;
      turn_ = sample.position;
      const auto slot = [&](int run_number) -> double& {
        return runs_[static_cast<std::size_t>(run_number) % runs_.size()];
      };
      slot(run_count_++) = sample.time;
      const int first = run_count_ - options_.chatter_runs;
      if (first >= 0 && sample.time - slot(first) <= options_.chatter_time) {
        return SignalFault::chatter;
      }
    }
  }
  return SignalFault::none;
}

}  // namespace palpate::probing
