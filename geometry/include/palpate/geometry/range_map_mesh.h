// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct RangeMapMeshOptions {
  /// Two neighbouring pixels lie on one surface iff their depths differ by at most this fraction of
  /// the nearer one, or by as much as the slope on both sides of them explains, give or take this
  /// fraction; > 0. A steep surface that is smooth is thus no step.
  double max_depth_step = 0.02;
  /// A triangle is kept iff the angle between its normal and its viewing ray is at most this [rad];
  /// in (0, pi/2].
  double max_incidence = 1.4;
};

struct RangeMapMesh {
  TriangleMesh mesh;       ///< camera frame [mm]; normals point towards the camera
  std::vector<int> pixel;  ///< row * width + col of each vertex, ascending
  int width = 0;           ///< [px] of the range map
  int height = 0;          ///< [px]
};

/// Joins neighbouring pixels into triangles, two a cell of four pixels, along the shorter diagonal,
/// one where a corner is unknown; cuts at depth steps and where the surface is seen at a grazing
/// angle. Pixels in no triangle give no vertex; a map without any surface gives a mesh without
/// triangles. Depths that are not finite or not positive are unknown.
/// \throws InvalidInput on a bad camera, or an option outside its range.
[[nodiscard]] RangeMapMesh mesh_range_map(const RangeMap& map,
                                          const RangeMapMeshOptions& options = {});

}  // namespace palpate::geometry
