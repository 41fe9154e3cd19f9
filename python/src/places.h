// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::python {

/// By which places on another mesh are recognised; those on the same mesh in another shape are not,
/// and need not be.
struct MeshSize {
  Eigen::Index vertices = 0;
  Eigen::Index triangles = 0;

  bool operator==(const MeshSize&) const = default;
};

[[nodiscard]] inline MeshSize mesh_size(const geometry::TriangleMesh& mesh) {
  return {.vertices = mesh.vertices.cols(), .triangles = mesh.triangles.cols()};
}

struct PlacesOnMesh : geometry::ClosestPoints {
  MeshSize mesh;
};

}  // namespace palpate::python
