// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Signed distance [mm] of each point (3 x N) from a surface: positive on the side of the surface's
/// normals, also where an edge or a vertex is nearest. NaN for a point that is not finite.
/// \throws InvalidInput if `surface` is not a valid mesh.
[[nodiscard]] Eigen::VectorXd distances_to_surface(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                   const TriangleMesh& surface);

/// Distance [mm] >= 0 of each point (3 x N) from a surface, for the part that both have in common.
/// NaN where the nearest point is on the surface's border, where the distance exceeds
/// `max_distance`, and for a point that is not finite.
/// \throws InvalidInput if `surface` is not a valid mesh, or unless max_distance > 0.
[[nodiscard]] Eigen::VectorXd distances_in_both(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, const TriangleMesh& surface,
    double max_distance = std::numeric_limits<double>::infinity());

struct HausdorffOptions {
  /// Largest gap between the bounds, as a fraction of the lower one (at least 1e-9 of the diagonal
  /// of both meshes); in (0, 1]. A mesh whose triangles would have to be divided into too many
  /// pieces, because its features differ in size by many orders of magnitude, gets a larger gap.
  double max_gap = 0.01;
};

/// Bounds of the largest distance of a point of one surface from another surface: sup over x of inf
/// over y of |x - y|.
struct LargestDistance {
  double lower = 0;                                   ///< [mm] distance of `at`
  double upper = 0;                                   ///< [mm] no point is farther away
  Eigen::Vector3d at = Eigen::Vector3d::Constant(0);  ///< [mm] a point on the first surface
};

/// One-sided Hausdorff distance from all points of the surface `from`, not only its vertices, to
/// the surface `to`. Both bounds hold up to the rounding of the coordinates.
///
/// Branch and bound over pieces of the triangles of `from`. The distance to one triangle is a
/// convex function, so on a piece its maximum is at a corner; the best of a few triangles of `to`
/// bounds the distance to all of `to`. Where the bound is too loose, the piece is cut along the
/// edges of that triangle, or halved. Far from the origin nothing is lost, because coordinates are
/// moved near it without rounding. Vertices without triangles are ignored.
/// \throws InvalidInput if a mesh is not valid or an option is outside its range.
[[nodiscard]] LargestDistance one_sided_hausdorff_distance(const TriangleMesh& from,
                                                           const TriangleMesh& to,
                                                           const HausdorffOptions& options = {});

struct HausdorffDistance {
  double lower = 0;  ///< [mm] the larger lower bound of both directions
  double upper = 0;  ///< [mm] the larger upper bound of both directions
  LargestDistance a_to_b;
  LargestDistance b_to_a;
};

/// Hausdorff distance: the larger of both one-sided distances. The gap is relative to the larger.
/// \throws InvalidInput if a mesh is not valid or an option is outside its range.
[[nodiscard]] HausdorffDistance hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b,
                                                   const HausdorffOptions& options = {});

struct SurfaceDistanceOptions {
  /// Approximate number of equal-area cells that cover `from`, at least one per triangle; in
  /// [1, 1e8].
  int cells = 100000;
};

/// Distribution over its area of the distances from one surface to another.
struct SurfaceDistances {
  double mean = 0;    ///< [mm] of the signed distances
  double rms = 0;     ///< [mm] square root of the mean square
  double median = 0;  ///< [mm] absolute distance not exceeded on half of the area
  double p90 = 0;     ///< [mm] absolute distance not exceeded on nine tenths of the area
  double area = 0;    ///< [mm^2] of `from`
  /// `from` with each triangle divided into n x n equal ones, grouped by triangle; neighbouring
  /// triangles of `from` share only its vertices.
  TriangleMesh cells;
  Eigen::VectorXd distance;  ///< [mm] signed mean distance of each cell
};

/// Computes the signed distances (see `distances_to_surface`) from `from` to the surface `to`, by
/// the three-point rule on each cell, which is exact for the mean square of a linear function.
/// \throws InvalidInput if a mesh is not valid, `from` has no area, the squares of areas or
/// distances overflow, or an option is outside its range.
[[nodiscard]] SurfaceDistances surface_distances(const TriangleMesh& from, const TriangleMesh& to,
                                                 const SurfaceDistanceOptions& options = {});

}  // namespace palpate::geometry
