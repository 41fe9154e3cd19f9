// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "placement/ball_points.h"

namespace palpate::probing {

/// Returns why no pose explains these positions of the ball: another radius or unit, left-handed
/// axes, or wrong orientations.
[[nodiscard]] std::optional<std::string> impossible_balls(const BallPoints& balls,
                                                          double ball_radius);

/// Doubts lengths that differ between arm and camera.
/// \param deviation [mm] of a coordinate.
void doubt_balls(const BallPoints& balls, const std::vector<Eigen::Index>& used, double deviation,
                 BallPlacement& placement);

}  // namespace palpate::probing
