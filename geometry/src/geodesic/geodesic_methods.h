// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "palpate/geometry/geodesic_distance.h"

namespace palpate::geometry {

/// Implements `geodesic_distance` for GeodesicMethod::fast_marching. Precondition: sources and
/// radius are valid.
[[nodiscard]] GeodesicDistance fast_marching_distance(const GeodesicSurface& surface,
                                                      std::span<const SurfacePoint> sources,
                                                      double stop_radius);

/// Implements `geodesic_distance` for GeodesicMethod::exact. Precondition: sources and options are
/// valid.
/// \throws InvalidInput naming a triangle without area, or an edge that is not manifold.
[[nodiscard]] GeodesicDistance exact_geodesic_distance(const GeodesicSurface& surface,
                                                       std::span<const SurfacePoint> sources,
                                                       const GeodesicOptions& options);

/// Adds sources one by one: `next` gets the distances of `fast_marching_distance` to those so far
/// ([mm] V; infinity without a source), and gives another one, or none to end. A new source changes
/// only its own cell, so many take little longer than all of them at once.
/// Precondition: the mesh is valid, and the sources are on it.
void grow_distances(
    const TriangleMesh& mesh,
    const std::function<std::optional<SurfacePoint>(const Eigen::VectorXd& distances)>& next);

}  // namespace palpate::geometry
