// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct RemeshingOptions {
  std::optional<double> edge_length = {};  ///< must be given
  double feature_angle = std::numbers::pi / 3;
  int max_triangles = 20'000'000;
  /// Called in the calling thread after each part of the work; the last call has done == total.
  /// If it throws, the remeshing ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(RemeshingOptions& options, FieldVisitor& visitor);

struct Remeshing {
  TriangleMesh mesh;
  /// Places of the vertices of `mesh` on the input, for `interpolated_attributes`. A vertex is in
  /// its place within rounding; one on a feature within kFeatureTolerance of the edge length.
  std::vector<SurfacePoint> places;
};

/// A vertex on a feature may be moved or left out only if it is on the straight line between its
/// neighbours there, within this fraction of the edge length.
inline constexpr double kFeatureTolerance = 1e-4;

/// Makes the triangles of a surface nearly equilateral, with edges of one length.
///
/// In each iteration, edges longer than 4/3 of the length are split and those shorter than 4/5 of
/// it are collapsed, edges are flipped until they are Delaunay, and vertices are moved along the
/// surface to the middle of their triangles and onto the input (Botsch and Kobbelt 2004; flips by
/// angles instead of valences).
///
/// Features (the border, and edges at which the surface bends by more than `feature_angle`) stay
/// where they are: their vertices are moved along it or left out only where it is straight. Edges
/// along a feature that bends more often than once in `edge_length` are therefore shorter. The
/// topology does not change. No triangle is turned over by a step; a vertex for which that cannot
/// be avoided stays short of its best place.
/// \throws InvalidInput if the mesh is not valid or an option is outside its range, as
/// `opposite_half_edges`, naming a vertex at which several fans of triangles meet, or if more
/// triangles than `max_triangles` would be needed.
[[nodiscard]] Remeshing remesh(const TriangleMesh& mesh, const RemeshingOptions& options);

}  // namespace palpate::geometry
