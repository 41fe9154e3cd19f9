// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
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

/// The distances of `fast_marching_distance` while sources are added. A new source changes only its
/// own cell, so many sources take little longer than all of them at once.
class GrowingDistance {
 public:
  /// Precondition: the mesh is valid, and outlives this.
  explicit GrowingDistance(const TriangleMesh& mesh);
  ~GrowingDistance();
  GrowingDistance(const GrowingDistance&) = delete;
  GrowingDistance& operator=(const GrowingDistance&) = delete;

  /// Precondition: the source is on the mesh.
  void add(const SurfacePoint& source);
  /// [mm] V, to the nearest source; infinity if there is none.
  [[nodiscard]] const Eigen::VectorXd& distance() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::geometry
