// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "regions/unwrapping.h"

namespace palpate::sensing {

/// Finds the smooth regions by growing snakes (thesis 3.3.4; see `SnakeContour` for
/// the forces) and unwraps each in order of quality from the centre of the
/// circle its snake began as (3.3.5): the alternative to `grow_regions`, which
/// knows nothing of the shape of a region.
///
/// Differs from the thesis: the circles are not placed at random but where the
/// phase around is smoothest and no region has been found yet, so that the same
/// image always gives the same regions; pixels that no snake reached, within
/// two pixels of one region, join it. Pixels of a larger phase variance than
/// the limit take part in the unwrapping, and belong to no region in the end.
void grow_snakes(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                 Regions& regions);

}  // namespace palpate::sensing
