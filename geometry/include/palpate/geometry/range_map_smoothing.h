// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/core/fields.h"
#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct RangeMapSmoothingOptions {
  int radius_px = 3;
  double max_residual = 4;
  double max_move = 1;
};

void visit(RangeMapSmoothingOptions& options, FieldVisitor& visitor);

/// Reduces the noise of depths in accordance with their predicted deviations.
///
/// Each depth moves towards a second-order surface through its neighbours, fitted by least squares
/// to 1 / z, which is linear in the pixel on any plane, so that planes stay planes. Neighbours are
/// weighted by 1 / variance and by Tukey's biweight of their residual, so that steps stay in place.
/// \param sigma  [mm] standard deviation of each depth, of the size of `z`. A depth without one
///               (NaN, or not > 0) stays unchanged and does not affect its neighbours.
/// \return       depths, known where those of `z` are known.
/// \throws InvalidInput unless both have the same size and every option is in its range.
[[nodiscard]] ImageF smooth_range_map(const ImageF& z, const ImageF& sigma,
                                      const RangeMapSmoothingOptions& options = {});

}  // namespace palpate::geometry
