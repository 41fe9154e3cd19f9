// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

namespace palpate::sensing {

/// Numbers frames from 0 by a camera's counter, which may begin anywhere. A 16-bit counter, such as
/// that of GigE Vision, follows 65535 with 1. One that stands still does not show lost frames.
class NumbersByCounter {
 public:
  [[nodiscard]] std::uint64_t next(std::uint64_t counter);

 private:
  bool any_ = false;
  std::uint64_t last_counter_ = 0;
  std::uint64_t number_ = 0;
};

/// Numbers frames from 0 by their times, for a camera without a counter: an interval of about n
/// usual ones means that n - 1 frames are missing. The usual interval is the median of the last
/// ones, because cameras expose longer, and so send fewer frames, when it gets dark.
class NumbersByTime {
 public:
  /// \param rate as the camera states it [frames/s]; 0 if it does not.
  explicit NumbersByTime(double rate) : rate_(rate) {}
  /// \param time [s], not before that of the last frame.
  [[nodiscard]] std::uint64_t next(double time);

 private:
  double rate_;
  bool any_ = false;
  double last_time_ = 0;
  std::uint64_t number_ = 0;
  std::deque<double> intervals_;
};

}  // namespace palpate::sensing
