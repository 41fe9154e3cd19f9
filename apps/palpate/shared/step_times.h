// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "palpate/geometry/range_map_score.h"
#include "palpate/haptics/playback.h"

namespace palpate::apps {

/// How long single steps of the haptic loop take [us], by what the contact did in them.
struct StepTimes {
  geometry::ErrorStatistics all, free, stick, slip;
};

/// Plays a trajectory once more, with a clock around every step.
[[nodiscard]] StepTimes time_steps(const haptics::Playback& playback,
                                   std::span<const haptics::TrajectoryPoint> trajectory);

}  // namespace palpate::apps
