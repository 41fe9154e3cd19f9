// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/work_steps.h"
#include "palpate/geometry/contact_triangulation.h"

namespace palpate::geometry {

/// Result of both methods: triangles of contacts that may still touch in single vertices.
struct TrianglesOfContacts {
  std::vector<std::array<int, 3>> triangles;
  SurfaceWeights weights;          ///< if empty, to be projected onto the triangles
  Eigen::VectorXi surface_labels;  ///< see ContactTriangulation
  IntrinsicDelaunay intrinsic;
};

/// Pinned intrinsic coarsening. `places`: positions of the contacts [mm]. `steps` counts the
/// vertices removed. Precondition: valid input.
[[nodiscard]] TrianglesOfContacts coarsen_to_contacts(const TriangleMesh& surface,
                                                      std::span<const SurfacePoint> contacts,
                                                      const Eigen::Matrix3Xd& places,
                                                      WorkSteps& steps);

/// Dual of geodesic Voronoi cells, with edges already manifold. Precondition: valid input.
[[nodiscard]] TrianglesOfContacts voronoi_dual(const TriangleMesh& surface,
                                               std::span<const SurfacePoint> contacts,
                                               const Eigen::Matrix3Xd& places);

}  // namespace palpate::geometry
