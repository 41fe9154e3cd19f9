// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "palpate/haptics/playback.h"

namespace palpate::haptics {

/// Moves a tool on straight lines, and counts what its user feels.
struct Hand {
  const Playback& playback;
  Eigen::Vector3d tool;
  LoopState state;
  Command last;
  double work = 0;            // [N mm] by the object on the user
  double largest_change = 0;  // [N] of the force in a tick
  int free = 0, slips = 0;    // ticks

  Hand(const Playback& loop, const Eigen::Vector3d& start) : playback(loop), tool(start) {
    last = playback.step(start, state);
  }
  void step(const Eigen::Vector3d& to) {
    const Command now = playback.step(to, state);
    work += (now.force + last.force).dot(to - tool) / 2;
    largest_change = std::max(largest_change, (now.force - last.force).norm());
    free += now.state == ContactState::free;
    slips += now.state == ContactState::slip;
    tool = to;
    last = now;
  }
  /// In steps of at most this length [mm].
  void go(const Eigen::Vector3d& to, double step_length) {
    const Eigen::Vector3d from = tool;
    const int steps = static_cast<int>(std::ceil((to - from).norm() / step_length));
    for (int i = 1; i <= steps; ++i) step(from + (to - from) * i / steps);
  }
};

inline constexpr double kTick = 0.03;  // [mm] in a tick: 30 mm/s

}  // namespace palpate::haptics
