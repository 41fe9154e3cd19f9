// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "regions/joined_regions.h"
#include "regions/unwrapping.h"

namespace palpate::sensing {

/// One group of joined regions.
struct RegionGroup {
  int number = 0;
  long pixels = 0;
  long top = 0;  ///< first and last row
  long bottom = -1;
};
/// All groups, in the order of their numbers.
[[nodiscard]] std::vector<RegionGroup> region_groups(const Regions& regions,
                                                     const JoinedRegions& joined);

/// Calls f(row, column) for each pixel of a group.
template <typename F>
void for_each_pixel(const Regions& regions, const JoinedRegions& joined, const RegionGroup& group,
                    F f) {
  for (long row = group.top; row <= group.bottom; ++row) {
    for (long column = 0; column < regions.label.cols(); ++column) {
      const int label = regions.label(row, column);
      if (label >= 0 && joined.group[static_cast<std::size_t>(label)] == group.number) {
        f(row, column);
      }
    }
  }
}

/// A pixel of a group, or one in no region whose phase follows from the phases beside it in the
/// row.
struct RegionSample {
  int row = 0;
  int column = 0;
  double phase = 0;  ///< [rad] with the turns that join the group
  int region = -1;   ///< -1 in no region
};

/// Samples a group evenly: its pixels; those of gaps up to `max_gap` px between its runs, by
/// interpolation; and a few in no region beyond the other ends of its runs, by extrapolation.
[[nodiscard]] std::vector<RegionSample> sample_group(const Regions& regions,
                                                     const JoinedRegions& joined,
                                                     const RegionGroup& group, int max_gap);

}  // namespace palpate::sensing
