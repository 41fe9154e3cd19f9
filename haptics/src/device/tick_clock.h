// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::haptics {

/// The clock of a simulated device: that of the host, or one that stands still while nobody reads.
class TickClock {
 public:
  TickClock(double period, bool real_time) noexcept : period_(period), real_time_(real_time) {}

  /// [s] CLOCK_MONOTONIC, or the time of the last tick.
  [[nodiscard]] double now() const noexcept;
  /// Sleeps until the next tick in real time. Returns how many ticks it is since the last one: 1,
  /// or more if the caller is late, at most `kMostTicks`.
  int wait() noexcept;
  /// Ticks since the first wait.
  [[nodiscard]] long long ticks() const noexcept { return ticks_; }

  static constexpr int kMostTicks = 1000;

 private:
  double period_;  // [s]
  bool real_time_;
  double start_ = 0;  // [s] of tick 0 in real time
  long long ticks_ = 0;
};

}  // namespace palpate::haptics
