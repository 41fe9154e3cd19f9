// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The geodesic Delaunay triangulation of contact points: the dual of their geodesic Voronoi cells
/// (thesis 5.3.2.1).
struct ContactTriangulation {
  /// Vertices: the contacts, in their order [mm]. Triangles: oriented as the surface, none without
  /// area; always a manifold with border (an edge has at most one triangle on each side, a vertex
  /// one fan).
  TriangleMesh mesh;
  /// Voronoi cell of each vertex of the surface, V; -1 = not reached (a part without contact).
  Eigen::VectorXi surface_labels;
  /// Contacts that are in no triangle (too few cells meet there), ascending; empty when all is
  /// well.
  std::vector<int> isolated;
};

/// Each place where three cells meet becomes a triangle of their contacts. The dual of geodesic
/// cells is not always a triangulation (thesis 5.3.2.1 says so of thin parts with few contacts): a
/// triangle that is turned over against the surface at its contacts is left out, and of triangles
/// that exclude each other the one whose cells meet nearest to its contacts stays. Cells that would
/// meet beyond the border of the surface give none, so contacts need some surface around them.
/// \throws InvalidInput on a bad mesh, fewer than three contacts, two at one place (within 1e-9 of
/// the surface's diagonal), one not on the surface, or when no three cells meet.
[[nodiscard]] ContactTriangulation triangulate_contacts(const TriangleMesh& surface,
                                                        std::span<const SurfacePoint> contacts);

/// Weights of three contacts at a place of the surface.
struct ContactWeights {
  Eigen::Vector3i contacts = Eigen::Vector3i::Constant(-1);  ///< -1 = the place is not finite
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();         ///< >= 0, sums to 1
};

/// Barycentric coordinates in the contact triangulation, for any point on or near the surface:
/// those of the nearest point of the flat triangles. Continuous wherever that point is the only
/// nearest one: on and near the triangles, and beyond a convex border, where the weights are held
/// constant outwards; in a notch of the border there is a line between its sides where they jump.
/// Thread-safe, does not allocate, does not throw.
class ContactLocator {
 public:
  /// \throws InvalidInput if the mesh is not valid (see `check_mesh`).
  explicit ContactLocator(const TriangleMesh& contact_mesh);
  [[nodiscard]] ContactWeights locate(const Eigen::Vector3d& point) const noexcept;

 private:
  Eigen::Matrix3Xi triangles_;
  SurfaceQuery query_;
};

}  // namespace palpate::geometry
