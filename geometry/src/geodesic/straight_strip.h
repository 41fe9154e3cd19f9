// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geodesic/triangle_strip.h"

namespace palpate::geometry {

/// A path through a strip of triangles.
struct StraightPath {
  double length = 0;                 ///< in the unit of the flat triangles
  std::vector<SurfacePoint> points;  ///< each in a triangle that also has the point before it
};

/// Shortens a path until no vertex that it touches can be passed more shortly on the other side.
///
/// The shortest path in the strip is found by the funnel of Lee and Preparata (1984). If it
/// touches a vertex with less than a straight angle on the side without the strip, the strip is
/// led round that side (Xin and Wang 2007; Mancinelli, Nazzaro, Pellacini and Puppo 2022), as by
/// the flips of Sharp and Crane (2020) at such a vertex. The path gets shorter each time and never
/// leaves its homotopy class, because it moves only across vertices. Precondition: `strip` is
/// trimmed.
[[nodiscard]] StraightPath straighten(const FlatTriangles& flat, TriangleStrip strip);

}  // namespace palpate::geometry
