// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The geodesic Delaunay triangulation of contact points: the dual of their geodesic Voronoi cells
/// (thesis 5.3.2.1).
struct ContactTriangulation {
  TriangleMesh mesh;               ///< vertices: the contacts, in their order; triangles oriented as the surface
  Eigen::VectorXi surface_labels;  ///< Voronoi cell of each vertex of the surface; -1 = not reached
  /// Contacts that are in no triangle (too few cells meet there); empty when all is well.
  std::vector<int> isolated;
};

/// \throws InvalidInput on fewer than three contacts, two at one place, one not on the surface, or when
///         the cells give no triangle at all.
[[nodiscard]] ContactTriangulation triangulate_contacts(const TriangleMesh& surface,
                                                        std::span<const SurfacePoint> contacts);

/// Weights of at most three contacts at a place of the surface.
struct ContactWeights {
  Eigen::Vector3i contacts = Eigen::Vector3i::Constant(-1);
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< >= 0, sums to 1
};

/// Barycentric coordinates in the contact triangulation, for any point on or near the surface: those of
/// the nearest point of the flat triangles, continuous, and held constant outwards beyond their border.
/// Thread-safe, does not allocate, does not throw.
class ContactLocator {
 public:
  explicit ContactLocator(const TriangleMesh& contact_mesh);
  [[nodiscard]] ContactWeights locate(const Eigen::Vector3d& point) const noexcept;

 private:
  Eigen::Matrix3Xi triangles_;
  SurfaceQuery query_;
};

}  // namespace palpate::geometry
