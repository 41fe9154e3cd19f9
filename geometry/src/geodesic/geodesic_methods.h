// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/geometry/geodesic_distance.h"

namespace palpate::geometry {

/// Implements `geodesic_distance` for GeodesicMethod::fast_marching. Precondition: mesh, sources
/// and radius are valid.
[[nodiscard]] GeodesicDistance fast_marching_distance(const TriangleMesh& mesh,
                                                      std::span<const SurfacePoint> sources,
                                                      double stop_radius);

/// Implements `geodesic_distance` for GeodesicMethod::exact. Precondition: mesh, sources and radius
/// are valid.
/// \throws InvalidInput naming a triangle without area, or an edge that is not manifold.
[[nodiscard]] GeodesicDistance exact_geodesic_distance(const TriangleMesh& mesh,
                                                       std::span<const SurfacePoint> sources,
                                                       double stop_radius);

}  // namespace palpate::geometry
