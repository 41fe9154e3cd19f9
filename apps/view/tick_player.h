// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "felt_loop.h"

namespace palpate::view {

/// Ticks that are played at their pace, or from any time on.
class TickPlayer {
 public:
  explicit TickPlayer(std::vector<FeltTick> ticks) : ticks_(std::move(ticks)) {}

  /// Lets time go by [s] while it plays; at the end it stops.
  void advance(double seconds);
  /// Goes to a time [s], forwards or back.
  void seek(double seconds);
  /// Stops, or goes on; from the beginning if it was at the end.
  void toggle();

  [[nodiscard]] bool is_playing() const { return is_playing_; }
  [[nodiscard]] double time() const { return cursor_ * kLoopPeriod; }  ///< [s]
  [[nodiscard]] double duration() const {                              ///< [s]
    return static_cast<double>(ticks_.size()) * kLoopPeriod;
  }

  struct Part {
    std::span<const FeltTick> ticks;
    bool anew = false;  ///< time went back: these ticks do not follow those of the last part
  };
  /// The ticks since the last part, but only the latest `most`.
  [[nodiscard]] Part take(std::size_t most);

 private:
  std::vector<FeltTick> ticks_;
  double cursor_ = 0;  // [ticks]
  std::size_t taken_ = 0;
  bool is_playing_ = true;
};

}  // namespace palpate::view
