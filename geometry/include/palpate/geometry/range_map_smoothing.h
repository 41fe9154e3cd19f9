// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

struct RangeMapSmoothingOptions {
  int radius_px = 3;  ///< the window is 2 radius_px + 1 wide and high; in [1, 15]
  /// A neighbour that is off the surface through the others by >= max_residual of its deviation
  /// belongs to another surface, and has no weight; > 0.
  double max_residual = 4;
  /// No depth moves by more than max_move of its deviation; > 0.
  double max_move = 1;
};

/// Takes noise from depths, as far as their predicted deviation says that it is noise. Each depth
/// moves towards a surface of second order through its neighbours: least squares on 1 / z, which is
/// linear in the pixel on any plane, so that planes stay planes; each neighbour weighted by 1 /
/// variance and by Tukey's biweight of its residual, so that steps stay where they are.
///
/// \param sigma  [mm] standard deviation of each depth, of the size of `z`. A depth without one
///               (NaN, or not > 0) stays as it is and says nothing of its neighbours.
/// \return       depths, known where those of `z` are known.
/// \throws InvalidInput unless both have the same size, or on an option outside its range.
[[nodiscard]] ImageF smooth_range_map(const ImageF& z, const ImageF& sigma,
                                      const RangeMapSmoothingOptions& options = {});

}  // namespace palpate::geometry
