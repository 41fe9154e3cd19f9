// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// Returns the range map that the same camera would give if its lens had no distortion, for
/// programs that know only pinhole cameras: size, focal lengths and principal point stay.
///
/// The depth of a pixel is that of the surface of `mesh_range_map` where its ray meets it first.
/// Depths are therefore interpolated along a surface, never across a depth step. Pixels that no
/// triangle covers are unknown: single pixels without a neighbour, and what the lens shows outside
/// the pinhole's image. A map without distortion keeps the depths of all pixels with a triangle, up
/// to rounding.
/// \throws InvalidInput unless the camera is valid and of the size of `z`.
[[nodiscard]] RangeMap undistorted(const RangeMap& map);

}  // namespace palpate::geometry
