// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "regions/unwrapping.h"

namespace palpate::sensing {

/// Finds the smooth regions with growing snakes (thesis 3.3.4; see `SnakeContour` for the forces)
/// and unwraps each in order of quality from the centre of its snake's initial circle (3.3.5). This
/// is the alternative to `grow_regions`, which ignores the shape of a region.
///
/// Differs from the thesis: the circles are not placed at random but where the phase is smoothest
/// and no region has been found yet, so that the result is deterministic; pixels that no snake
/// reached but that lie within two pixels of exactly one region join it. Pixels whose phase
/// variance exceeds the limit take part in the unwrapping but belong to no region in the result.
void grow_snakes(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                 Regions& regions);

}  // namespace palpate::sensing
