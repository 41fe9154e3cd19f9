// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct RangeMapMeshOptions {
  /// No triangle joins two neighbouring pixels whose depths differ by more than this fraction of
  /// their depth; > 0.
  double max_depth_step = 0.02;
  /// No triangle whose normal is further than this from its viewing ray [rad]; in (0, pi/2].
  double max_incidence = 1.4;
};

struct RangeMapMesh {
  TriangleMesh mesh;       ///< camera frame [mm]; normals point towards the camera
  std::vector<int> pixel;  ///< row * cols + col of each vertex
};

/// Joins neighbouring pixels into triangles, two a cell, the shorter diagonal; cuts at depth steps
/// and where the surface is seen at a grazing angle. Pixels in no triangle give no vertex.
/// \throws InvalidInput on a bad camera, or an option outside its range.
[[nodiscard]] RangeMapMesh mesh_range_map(const RangeMap& map, const RangeMapMeshOptions& options = {});

}  // namespace palpate::geometry
