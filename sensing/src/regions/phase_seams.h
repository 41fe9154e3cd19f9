// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "regions/phase_offset.h"

namespace palpate::sensing {

/// Conditions for a surface to continue across a seam between two regions.
struct SeamLimits {
  /// Smallest width of a seam [px]. 1 excludes the borders cut by `split_regions`, across which the
  /// phase is continuous by construction.
  int min_width = 0;
  /// Largest width of a seam [px], in rows and columns. It must be below one period, because a
  /// depth step of a whole period throws a shadow one period wide.
  int max_width = 0;
  /// An offset is accepted if this share of the border gives it; in (0.5, 1].
  double min_agreement = 0;
};

/// Solves regions without stripe edges (no_transition) from their solved neighbours.
///
/// The phases on both sides of a seam are extrapolated to its middle along the row or column with
/// their local slopes. The offset is accepted if the border is long enough and if, along almost all
/// of it and for every neighbour, the extrapolated phases differ by nearly the same whole number of
/// turns, without a bias; at a depth step of another height the turns vary along the border. If the
/// neighbours give different numbers, the region becomes ambiguous_offset; if there is no whole
/// number, it stays no_transition. Regions solved in this way can solve others.
void solve_from_neighbours(const Regions& regions, const SeamLimits& limits,
                           std::vector<RegionOffset>& offsets);

}  // namespace palpate::sensing
