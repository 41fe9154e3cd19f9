// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "regions/phase_offset.h"

namespace palpate::sensing {

/// What counts as the continuation of a surface across a seam.
struct SeamLimits {
  /// Seams are at least so wide [px]. Where `split_regions` has cut, the phase
  /// is continuous by construction, which says nothing: 1 to leave such borders
  /// out.
  int min_width = 0;
  /// Seams are at most so wide [px], in rows and columns. A step of the depth
  /// by a whole period throws a shadow one period wide: below a period.
  int max_width = 0;
  /// The offset is accepted iff this share of the border asks for it; in (0.5,
  /// 1].
  double min_agreement = 0;
};

/// Gives regions without stripe edges (no_transition) the offset that continues
/// their solved neighbours: the phases on both sides of a seam are extrapolated
/// along the row, or column, to its middle with the slopes that they have
/// there. The offset is accepted where the border is long enough, the
/// extrapolated phases come near the same whole number of turns along almost
/// all of it, whatever the neighbour, and do not lean to one side; the turns of
/// a depth step of some other height vary along the border. Where the phases
/// disagree on the number the region becomes ambiguous_offset; where they meet
/// at no whole number at all it stays no_transition. Regions solved so may
/// solve others.
void solve_from_neighbours(const Regions& regions, const SeamLimits& limits,
                           std::vector<RegionOffset>& offsets);

}  // namespace palpate::sensing
