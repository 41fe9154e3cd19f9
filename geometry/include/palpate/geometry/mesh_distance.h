// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct HausdorffOptions {
  /// The bounds are at most this fraction of the lower one apart (or 1e-9 of the diagonal of the
  /// mesh that is measured to, where that is more); in (0, 1].
  double max_gap = 0.01;
};

/// How far the furthest point of a surface is from another surface: sup over x of inf over y of
/// |x - y|, between two bounds.
struct LargestDistance {
  double lower = 0;                                   ///< [mm] so far away is `at`
  double upper = 0;                                   ///< [mm] no point is further
  Eigen::Vector3d at = Eigen::Vector3d::Constant(0);  ///< [mm] on the surface that is measured
};

/// The one-sided Hausdorff distance: of the points of `from`, all of them and not its vertices
/// alone, to the surface `to`. Both bounds hold, up to the rounding of the coordinates.
///
/// Branch and bound over pieces of `from`'s triangles. The distance to one triangle of `to` is a
/// convex function, so on a piece it is largest at a corner; with the best of a few triangles of
/// `to` that bounds the distance to all of `to`. Where the bound is too loose the piece is cut
/// along the edges of that triangle, or halved. Vertices in no triangle do not count. \throws
/// InvalidInput on a bad mesh, or an option outside its range.
[[nodiscard]] LargestDistance one_sided_hausdorff_distance(const TriangleMesh& from,
                                                           const TriangleMesh& to,
                                                           const HausdorffOptions& options = {});

struct HausdorffDistance {
  double lower = 0;  ///< [mm] the larger of both ways, as is the next
  double upper = 0;
  LargestDistance a_to_b;
  LargestDistance b_to_a;
};

/// The Hausdorff distance, the larger of both one-sided ones; the gap is a fraction of the larger.
/// \throws InvalidInput on a bad mesh, or an option outside its range.
[[nodiscard]] HausdorffDistance hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b,
                                                   const HausdorffOptions& options = {});

struct SurfaceDistanceOptions {
  /// About as many cells of equal area cover `from`, never less than one a triangle; in [1, 1e8].
  int cells = 100000;
};

/// How the distances from one surface to another are spread over its area.
struct SurfaceDistances {
  double mean = 0;    ///< [mm] of the signed distances
  double rms = 0;     ///< [mm] square root of the mean square
  double median = 0;  ///< [mm] half of the area is at most so far away
  double p90 = 0;     ///< [mm] nine tenths of the area are
  double area = 0;    ///< [mm^2] of `from`
  /// `from` with each triangle cut into n x n equal ones, those of one triangle after the other;
  /// neighbours share only the vertices of `from`.
  TriangleMesh cells;
  Eigen::VectorXd distance;  ///< [mm] signed mean over each cell
};

/// Signed distances (see `distances_to_surface`) of the points of `from` to the surface `to`, by
/// the three-point rule on each cell, which is exact for the mean square of a linear function.
/// \throws InvalidInput on a bad mesh, a mesh `from` without area, areas or distances whose squares
/// overflow, or an option outside its range.
[[nodiscard]] SurfaceDistances surface_distances(const TriangleMesh& from, const TriangleMesh& to,
                                                 const SurfaceDistanceOptions& options = {});

}  // namespace palpate::geometry
