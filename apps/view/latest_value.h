// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>

namespace palpate::view {

/// The latest value that one thread gives to another one. Neither waits for the other, and no value
/// is seen half written: three places, of which each thread has one and the third is exchanged.
template <typename Value>
class LatestValue {
 public:
  /// One thread.
  void write(const Value& value) noexcept {
    places_[back_] = value;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kPlace;
  }

  /// One other thread. The value that was written last; a default one before the first.
  [[nodiscard]] const Value& read() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kPlace;
    }
    return places_[front_];
  }

 private:
  static constexpr unsigned kPlace = 3, kFresh = 4;
  std::array<Value, 3> places_{};
  unsigned back_ = 0, front_ = 1;
  std::atomic<unsigned> middle_{2};
};

}  // namespace palpate::view
