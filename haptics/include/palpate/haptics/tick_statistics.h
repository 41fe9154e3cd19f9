// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace palpate::haptics {

/// Durations in nanoseconds, counted in bins of at most 1.6 % width. Adding is real-time safe.
class DurationHistogram {
 public:
  void add(std::uint64_t nanoseconds) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t largest() const noexcept { return largest_; }
  /// [ns] The upper end of the bin in which the share `part`, 0 to 1, of all is reached; 0 without
  /// any, at most the largest.
  [[nodiscard]] std::uint64_t quantile(double part) const noexcept;

 private:
  static constexpr int kBinsOfOctave = 64;
  static constexpr int kOctaves = 40;  // up to 2^45 ns, 10 hours
  std::array<std::uint64_t, static_cast<std::size_t>(kBinsOfOctave) * kOctaves> bins_{};
  std::uint64_t count_ = 0, largest_ = 0;
};

/// Timing of a loop.
struct TickStatistics {
  long long ticks = 0;
  long long late = 0;  ///< began more than half a period late
  double rate = 0;     ///< [Hz] ticks a second of the host's clock
  double p50 = 0;      ///< [us] computing time of a tick: median,
  double p999 = 0;     ///< [us] 99.9 %,
  double largest = 0;  ///< [us] and largest
};

}  // namespace palpate::haptics
