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
  double deviation = 0;  ///< largest of a region's number of periods; 0 if depths told it
  std::string problem;   ///< why the last region failed; empty unless all did
};

/// Decides how many periods each region's phase lacks and fills in `pixel` and `depth` of its
/// cells; the cells of regions where that fails are taken out.
[[nodiscard]] PeriodCount count_periods(WhiteView& view, const Carrier& carrier, const Rig& rig,
                                        const Pattern& pattern,
                                        const std::optional<geometry::ImageF>& depth);

}  // namespace palpate::sensing
