// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>

#include "measure.h"
#include "tables.h"

namespace palpate::bench {
namespace {

/// Returns true if the tool is behind the nearest part of the surface, and not beyond its border.
bool is_behind(const TouchedObject& object, const Eigen::Vector3d& tool) {
  constexpr double kLeastDepth = 0.02, kOnBorder = 1e-3;  // [mm]
  const geometry::ClosestPoint nearest = object.query.closest_point(tool);
  const double depth = (nearest.position - tool).dot(object.normal(nearest.at.triangle));
  return depth > kLeastDepth && object.to_border(nearest.position) > kOnBorder;
}

}  // namespace

void print_falls(double seconds) {
  fmt::print(
      "\n| friction | path | touching [s] | contacts that end | falls | longest fall [s] | changes "
      "above 0.2 N in a tick, largest [N] |\n|---|---|---|---|---|---|---|\n");
  for (const double friction : {0.0, 0.3, 0.9}) {
    const TouchedObject object = hand(friction);
    const haptics::Playback playback(object.model);
    for (const unsigned seed : {1U, 2U, 3U, 4U}) {
      haptics::LoopState state;
      haptics::ContactState before = haptics::ContactState::free;
      Eigen::Vector3d force_before = Eigen::Vector3d::Zero();
      int touched = 0, ended = 0, falls = 0, falling = 0, longest = 0, changes = 0;
      double largest = 0;
      for (const Eigen::Vector3d& tool :
           wander(object, static_cast<int>(1e3 * seconds), seed, touching)) {
        const haptics::Command command = playback.step(tool, state);
        const haptics::ContactState now = command.state;
        const double change = (command.force - force_before).norm();
        force_before = command.force;
        changes += change > 0.2 ? 1 : 0;
        largest = std::max(largest, change);
        const bool free = now == haptics::ContactState::free;
        const bool end = free && before != haptics::ContactState::free;
        touched += free ? 0 : 1;
        ended += end ? 1 : 0;
        if (end || falling > 0) {
          const bool fallen = free && is_behind(object, tool);
          falls += end && fallen ? 1 : 0;
          falling = fallen ? falling + 1 : 0;
          longest = std::max(longest, falling);
        }
        before = now;
      }
      fmt::print("| {} | {} | {:.1f} | {} | {} | {} | {}, {:.2g} |\n", friction, seed,
                 1e-3 * touched, ended, falls, 1e-3 * longest, changes, largest);
      std::fflush(stdout);
    }
  }
}

}  // namespace palpate::bench
