// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::pictures {

/// The result of a trial of a campaign.
enum class TrialKind { held, slipped, failed };

/// N trials of a campaign, in order.
struct TimeLine {
  Eigen::VectorXd hours;         ///< N: end of each trial since the campaign began; not decreasing
  std::vector<TrialKind> kinds;  ///< N
  Eigen::VectorXi contacts;      ///< N: number of the contact in the plan, from 0
};

/// Draws a campaign over its hours as a PNG of 1200 x 820 px. Upper chart: the number of trials so
/// far that held, slipped and failed. Lower chart: a mark for each trial at its contact, in the
/// same colours. Works without a display.
/// \throws InvalidInput naming what is empty, of another size, or out of order.
/// \throws OutputError if the picture cannot be written.
void draw_time_line(const std::filesystem::path& png, const TimeLine& trials,
                    const std::string& title);

}  // namespace palpate::pictures
