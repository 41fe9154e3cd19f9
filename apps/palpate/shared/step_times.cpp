// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/step_times.h"

#include <chrono>
#include <vector>

namespace palpate::apps {

StepTimes time_steps(const haptics::Playback& playback,
                     std::span<const haptics::TrajectoryPoint> trajectory) {
  using Clock = std::chrono::steady_clock;
  std::array<std::vector<double>, 3> by_state;
  std::vector<double> all;
  all.reserve(trajectory.size());
  for (std::vector<double>& times : by_state) times.reserve(trajectory.size());
  haptics::LoopState state;
  double before = trajectory.empty() ? 0 : trajectory.front().time;
  for (const haptics::TrajectoryPoint& point : trajectory) {
    const Clock::time_point start = Clock::now();
    const haptics::Command command = playback.step(point.tool, state, point.time - before);
    before = point.time;
    const double elapsed = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    by_state[static_cast<std::size_t>(command.state)].push_back(elapsed);
    all.push_back(elapsed);
  }
  const auto of = [&](haptics::ContactState s) {
    return geometry::error_statistics(by_state[static_cast<std::size_t>(s)]);
  };
  return {.all = geometry::error_statistics(all),
          .free = of(haptics::ContactState::free),
          .stick = of(haptics::ContactState::stick),
          .slip = of(haptics::ContactState::slip)};
}

}  // namespace palpate::apps
