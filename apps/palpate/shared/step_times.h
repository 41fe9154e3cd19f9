// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/geometry/error_statistics.h"
#include "palpate/haptics/playback.h"

namespace palpate::apps {

/// Duration of single steps of the haptic loop [us], by contact state.
struct StepTimes {
  geometry::ErrorStatistics all, free, stick, slip;
};

/// Plays a trajectory again and measures every step.
[[nodiscard]] StepTimes time_steps(const haptics::Playback& playback,
                                   std::span<const haptics::TrajectoryPoint> trajectory);

}  // namespace palpate::apps
