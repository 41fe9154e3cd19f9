// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/texture.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Target of a decimation; set exactly one of the first two. `visit` describes the fields.
struct DecimationOptions {
  std::optional<double> tolerance = {};
  std::optional<int> max_triangles = {};
  /// Called in the calling thread after each mesh that was made. `total` is a limit that
  /// is often not reached; the last call has done == total. If it throws, the decimation ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(DecimationOptions& options, FieldVisitor& visitor);

struct Decimation {
  TriangleMesh mesh;
  std::vector<int> source;  ///< input vertex of each vertex of `mesh`, ascending
  /// [mm] verified upper bound of the Hausdorff distance between `mesh` and the input, in both
  /// directions and including the border. 0 if the input is returned. `hausdorff_distance` bounds
  /// the same distance more loosely, by up to its `max_gap`.
  double distance = 0;
  int tries = 0;  ///< number of meshes that were made and checked
};

/// Reduces the number of triangles. The vertices are a subset of the input's, unchanged.
///
/// meshoptimizer collapses edges in the order of their quadric error (Garland and Heckbert 1997).
/// This error says little about the distance, so each mesh is checked with the bounds of
/// `hausdorff_distance`, and the allowed error is searched for the smallest mesh that passes.
///
/// A mesh passes if
/// - its distance is within the tolerance;
/// - its edges have one or two consistently oriented triangles, if the input's have;
/// - at no vertex more fans of triangles meet than in the input;
/// - no new triangle has zero area, or is turned by more than 90 degrees against the nearest input
///   triangles at all four of its centre and the midpoints between centre and corners.
///
/// If the tolerance is too small to remove anything, or the input already satisfies
/// `max_triangles`, the input is returned. Vertices without triangles are left out. With
/// `max_triangles` the result may have more triangles if no mesh tried passes.
/// \throws InvalidInput if the mesh is not valid or an option is outside its range.
[[nodiscard]] Decimation decimate(const TriangleMesh& mesh, const DecimationOptions& options);

struct TexturedDecimation {
  Decimation decimation;
  CornerTexture texture;  ///< of the triangles of `decimation.mesh`
};

/// The same for a mesh with a texture. Charts stay apart: the surface may lose vertices of a seam,
/// but does not open there, and each corner keeps a place in the texture that its vertex had in the
/// input.
///
/// With a tolerance, a mesh passes only if the texture is also displaced by no more than that, as
/// seen at seven places of each new triangle: its centre, half-way from there to its corners, and
/// the middle of its sides.
/// \throws InvalidInput also if the texture has another number of triangles.
[[nodiscard]] TexturedDecimation decimate(const TriangleMesh& mesh, const CornerTexture& texture,
                                          const DecimationOptions& options);

}  // namespace palpate::geometry
