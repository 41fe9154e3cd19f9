// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/frame_numbers.h"

#include <cmath>

#include "palpate/core/quantile.h"

namespace palpate::sensing {
namespace {

/// Numbers that a counter of 16 bits passes before it begins again; it leaves 0 out.
constexpr std::uint64_t kRound = 65535;

/// Intervals from which the usual one is taken, and how many are needed for that.
constexpr std::size_t kIntervals = 15;
constexpr std::size_t kLeastIntervals = 3;

}  // namespace

std::uint64_t NumbersByCounter::next(std::uint64_t counter) {
  if (any_) {
    const bool is_later = counter > last_counter_;
    const bool is_round =
        counter < last_counter_ && last_counter_ <= kRound && counter + kRound > last_counter_;
    number_ += is_later ? counter - last_counter_ : is_round ? counter + kRound - last_counter_ : 1;
  }
  any_ = true;
  last_counter_ = counter;
  return number_;
}

std::uint64_t NumbersByTime::next(double time) {
  if (any_) {
    const double interval = time - last_time_;
    const bool known = intervals_.size() >= kLeastIntervals;
    const double usual = known ? median(intervals_) : rate_ > 0 ? 1 / rate_ : interval;
    const double steps = usual > 0 ? std::round(interval / usual) : 1;
    number_ += steps > 1 ? static_cast<std::uint64_t>(steps) : 1;
    intervals_.push_back(interval);
    if (intervals_.size() > kIntervals) intervals_.pop_front();
  }
  any_ = true;
  last_time_ = time;
  return number_;
}

}  // namespace palpate::sensing
