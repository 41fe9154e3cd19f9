// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct RangeMapMeshOptions {
  double max_depth_step = 0.02;
  double max_incidence = 1.4;
};

void visit(RangeMapMeshOptions& options, FieldVisitor& visitor);

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
