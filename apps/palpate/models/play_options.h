// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace palpate::apps {

/// What a call of `palpate play` does.
enum class PlayWay : unsigned {
  trajectory = 1,  ///< forces along a trajectory, without a device
  simulated = 2,   ///< the loop with a simulated device
  driver = 4,      ///< the loop with a device behind a driver
  replay = 8,
  stability_of_hand = 16,
  stability_of_driver = 32,
  scene = 64,  ///< a scene file along the ways that it names
  scene_simulated = 128,
  scene_driver = 256,
  scene_replay = 512
};

/// \throws InvalidInput naming the first option that is given and does nothing in this way, and
/// what it needs.
void refuse_idle_options(const CLI::App& play, PlayWay way);

}  // namespace palpate::apps
