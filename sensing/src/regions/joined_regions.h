// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "regions/unwrapping.h"

namespace palpate::sensing {

/// A straight line through the phases at one end of a run of pixels of one region in a row.
struct PhaseEnd {
  int column = 0;    ///< the run's last pixel at this end
  double phase = 0;  ///< [rad] of the line at this pixel
  double slope = 0;  ///< [rad/px]
};
/// \param column   the run's last pixel at this end.
/// \param inward   -1 for the right end of a run, 1 for its left end.
/// \returns nothing if the run is too short for a slope.
[[nodiscard]] std::optional<PhaseEnd> phase_end(const Regions& regions, int row, int column,
                                                int inward);

/// Regions of one surface, as far as their phases show.
struct JoinedRegions {
  static constexpr int kNone = -1;
  std::vector<int> group;  ///< per region: 0 ... count - 1, or kNone
  std::vector<int> turns;  ///< per region, to be added to continue the phases of its group
  int count = 0;
};

/// Joins regions whose phases continue each other across stripes that a surface does not reflect:
/// the mean of the slopes on both sides of a gap leads to a whole number of turns, the same one in
/// nearly all rows. This is exact for a phase of constant curvature.
/// \param open per region: nonzero if it takes part; others stay in no group.
/// \param max_gap [px] widest gap.
void join_regions(const Regions& regions, const std::vector<std::uint8_t>& open, int max_gap,
                  JoinedRegions& joined);

}  // namespace palpate::sensing
