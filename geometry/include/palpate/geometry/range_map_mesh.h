// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct RangeMapMeshOptions {
  /// Two neighbouring pixels are on one surface if their depths differ by at most this fraction of
  /// the smaller depth, or agree within this fraction with the slopes on both sides; > 0. A smooth
  /// steep surface is therefore not cut.
  double max_depth_step = 0.02;
  /// A triangle is kept if the angle between its normal and its viewing ray is at most this [rad];
  /// in (0, pi/2].
  double max_incidence = 1.4;
};

struct RangeMapMesh {
  TriangleMesh mesh;        ///< camera frame [mm]; normals point towards the camera
  std::vector<int> source;  ///< pixel of each vertex, row * width + column, ascending
  int width = 0;            ///< [px] of the range map
  int height = 0;           ///< [px]
};

/// Triangulates a range map. Each cell of four pixels gives two triangles along its shorter
/// diagonal, or one if a corner is unknown. The mesh is cut at depth steps and where the surface is
/// seen at a grazing angle. Pixels without triangles give no vertex; a map without surface gives a
/// mesh without triangles. Depths that are not finite or not positive are unknown.
/// \throws InvalidInput if the camera is not valid or an option is outside its range.
[[nodiscard]] RangeMapMesh mesh_range_map(const RangeMap& map,
                                          const RangeMapMeshOptions& options = {});

}  // namespace palpate::geometry
