// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calibration/white_view.h"
#include "palpate/geometry/range_map.h"
#include "setup/carrier.h"

namespace palpate::sensing {

struct PeriodCount {
  double deviation = 0;  ///< largest standard deviation of a region's count; 0 if depths were given
  std::string problem;   ///< why the last region failed; empty unless all regions failed
};

/// Finds the number of periods that the phase of each region lacks, and sets `pixel` and `depth` of
/// its cells. Removes the cells of regions for which this fails.
[[nodiscard]] PeriodCount count_periods(WhiteView& view, const Carrier& carrier, const Rig& rig,
                                        const Pattern& pattern,
                                        const std::optional<geometry::ImageF>& depth);

}  // namespace palpate::sensing
