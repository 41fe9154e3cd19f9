// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// What to reach; exactly one of both is given.
struct DecimationOptions {
  double tolerance = 0;   ///< [mm] Hausdorff distance <= tolerance; > 0, or 0 = not given
  int max_triangles = 0;  ///< triangle count <= max_triangles, if it can be; > 0, or 0 = not given
};

struct Decimation {
  TriangleMesh mesh;
  std::vector<int> vertex;  ///< which vertex of the input each of `mesh` is, ascending
  /// [mm] verified after the fact: the Hausdorff distance between `mesh` and the input, both ways
  /// and border included, is at most this. 0 if the input is given back.
  double distance = 0;
  int tries = 0;  ///< meshes that were made and judged
};

/// Fewer triangles for the same surface. Vertices are a subset of the input's, unchanged; edges
/// collapse by meshoptimizer in the order of their quadric error (Garland and Heckbert 1997). That
/// error says little about the distance, so each mesh is judged by the bounds of
/// `hausdorff_distance`, and the error allowed to meshoptimizer is searched for the smallest mesh
/// that passes.
///
/// A mesh passes iff it keeps the tolerance; its edges have one or two triangles that agree, if all
/// of the input's have; at no vertex more fans of triangles meet than at that of the input; and no
/// new triangle is without area, or turned by more than 90 degrees against the input's triangles
/// nearest to its centre and to the points half-way from there to its corners, all four. A
/// tolerance too small to take anything away gives back the input, and so does a limit on the
/// triangles that it keeps already. With `max_triangles` the result has more triangles than that
/// where none that was tried passes. \throws InvalidInput on a bad mesh, or options outside their
/// range.
[[nodiscard]] Decimation decimate(const TriangleMesh& mesh, const DecimationOptions& options);

}  // namespace palpate::geometry
