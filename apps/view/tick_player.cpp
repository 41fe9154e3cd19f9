// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "tick_player.h"

#include <algorithm>
#include <cmath>

namespace palpate::view {

void TickPlayer::advance(double seconds) {
  const auto all = static_cast<double>(ticks_.size());
  if (is_playing_) cursor_ = std::min(all, cursor_ + seconds / kLoopPeriod);
  if (cursor_ >= all) is_playing_ = false;
}

void TickPlayer::seek(double seconds) {
  cursor_ = std::clamp(seconds / kLoopPeriod, 0.0, static_cast<double>(ticks_.size()));
}

void TickPlayer::toggle() {
  is_playing_ = !is_playing_;
  if (is_playing_ && cursor_ >= static_cast<double>(ticks_.size())) cursor_ = 0;
}

TickPlayer::Part TickPlayer::take(std::size_t most) {
  const auto end = static_cast<std::size_t>(std::round(cursor_));
  const bool anew = end < taken_;
  const std::size_t begin = std::max(anew ? 0 : taken_, end > most ? end - most : 0);
  taken_ = end;
  return {.ticks = std::span(ticks_).subspan(begin, end - begin), .anew = anew};
}

}  // namespace palpate::view
