// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace palpate::pictures {

/// An approach of a tip to an object.
struct Touch {
  Eigen::VectorXd times;      ///< [s] N, increasing; at least 20
  Eigen::VectorXd positions;  ///< [mm] N: along the approach, 0 where the surface was found
  double touched = 0;         ///< [s] when the tip came to the surface, as found; within `times`
};

/// Draws how a touch was found, as Figure 4.3 of the thesis: a PNG of 1200 x 820 px. Upper chart:
/// position over time, with the place and the time that were found. Lower chart: the speed by a
/// line through 20 positions around each time, which falls once the object pushes back. The last
/// time is that at which the touch was certain. Works without a display.
/// \throws InvalidInput naming what is too short, of another size, not finite, or out of order.
/// \throws OutputError if the picture cannot be written.
void draw_touch(const std::filesystem::path& png, const Touch& touch, const std::string& title);

}  // namespace palpate::pictures
