// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace palpate::probing {

/// One sample of an approach, along the direction in which the tip is pushed.
struct ApproachSample {
  double time = 0;      ///< [s] of the measurement, not of its arrival
  double position = 0;  ///< [mm] increases towards the object
  double force = 0;     ///< [N] that was commanded from this sample on, besides compensations
};

/// The fault of the signal of an approach.
enum class SignalFault {
  none,
  not_finite,      ///< a time, position or force is NaN or infinite
  time_backwards,  ///< a time is not after the one before it
  gap,             ///< samples are missing
  jump,            ///< faster than the arm can move
  frozen,          ///< the position does not change at all, although the arm pushes
  chatter,         ///< the position runs back and forth
  too_long,        ///< no contact within the longest approach
};

/// "position frozen", "time runs backwards" and so on.
[[nodiscard]] std::string_view to_string(SignalFault fault) noexcept;

struct SignalOptions {
  double quantum = 0.03;      ///< [mm] step between two positions that the encoders tell apart; > 0
  double longest_gap = 4e-3;  ///< [s] refused if the time since the last sample is longer; > 0
  double highest_speed = 1000;  ///< [mm/s] a step of more than this and 4 quanta is a jump; > 0
  double longest_rest = 0.1;    ///< [s] refused if the position is the same for longer; > 0
  double chatter_distance = 3;  ///< [quanta] a run back is longer than this; >= 1
  int chatter_runs = 3;         ///< refused if there are this many runs back within `chatter_time`
  double chatter_time = 0.2;    ///< [s] > 0
};

/// Checks the samples of an approach one by one. Real-time safe.
class SignalCheck {
 public:
  /// \throws InvalidInput on an option outside its range.
  explicit SignalCheck(const SignalOptions& options = {});

  /// The first fault of the signal so far; it stays.
  SignalFault check(const ApproachSample& sample) noexcept;
  [[nodiscard]] SignalFault fault() const noexcept { return fault_; }

 private:
  [[nodiscard]] SignalFault find(const ApproachSample& sample) noexcept;

  SignalOptions options_;
  SignalFault fault_ = SignalFault::none;
  bool any_ = false;
  ApproachSample last_;
  double rest_since_ = 0;
  double turn_ = 0;               // highest position since the last run back, or lowest within it
  bool back_ = false;             // within a run back
  std::array<double, 8> runs_{};  // [s] times of the latest runs back
  int run_count_ = 0;
};

}  // namespace palpate::probing
