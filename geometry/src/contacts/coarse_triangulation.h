// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"

namespace palpate::geometry {

/// What both methods hand over: triangles of contacts that may still touch in single vertices.
struct TrianglesOfContacts {
  std::vector<std::array<int, 3>> triangles;
  SurfaceWeights weights;          ///< empty: to be projected on the triangles
  Eigen::VectorXi surface_labels;  ///< see ContactTriangulation
  IntrinsicDelaunay intrinsic;
};

/// By pinned intrinsic coarsening. `places`: positions of the contacts [mm]. Pre: input checked.
[[nodiscard]] TrianglesOfContacts coarsen_to_contacts(const TriangleMesh& surface,
                                                      std::span<const SurfacePoint> contacts,
                                                      const Eigen::Matrix3Xd& places);

/// By the dual of geodesic Voronoi cells, edges already manifold. Pre: input checked.
[[nodiscard]] TrianglesOfContacts voronoi_dual(const TriangleMesh& surface,
                                               std::span<const SurfacePoint> contacts,
                                               const Eigen::Matrix3Xd& places);

}  // namespace palpate::geometry
