// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/geometry/geodesic_distance.h"

namespace palpate::geometry {

/// What geodesic_distance answers with GeodesicMethod::exact. Pre: mesh, sources and radius are
/// checked.
/// \throws InvalidInput naming a triangle without area, an edge or a vertex that is not manifold.
/// \throws SolverError where CGAL fails.
/// \throws Unavailable if the library was built without CGAL.
[[nodiscard]] GeodesicDistance exact_geodesic_distance(const TriangleMesh& mesh,
                                                       std::span<const SurfacePoint> sources,
                                                       double stop_radius);

}  // namespace palpate::geometry
