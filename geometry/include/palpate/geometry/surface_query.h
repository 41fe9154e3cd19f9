// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

class SurfaceTree;

struct ClosestPoint {
  SurfacePoint at;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
  double distance = 0;                                 ///< [mm]
};

struct SegmentHit {
  SurfacePoint at;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
  double fraction = 0;  ///< position along the segment, 0 at its start, 1 at its end
};

/// A half-line, optionally limited to a distance.
struct Ray {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();               ///< [mm]
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();            ///< any length except 0
  double max_distance = std::numeric_limits<double>::infinity();  ///< [mm] >= 0
};

struct RayHit {
  SurfacePoint at;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
  double distance = 0;                                 ///< [mm] from the origin
};

/// Closest-point and ray queries on a mesh, with a bounding volume hierarchy built by Embree.
///
/// The hierarchy only culls, in single precision on the centred and scaled mesh with a margin for
/// rounding; the remaining triangles are compared in double. The results therefore equal those of
/// an exhaustive search in double, also for a mesh 1 km from the origin. Among equally good
/// triangles the one with the lowest index is returned. Queries are const, thread-safe, do not
/// allocate and do not throw (batch queries and `all_hits` allocate their results).
class SurfaceQuery {
 public:
  /// \throws InvalidInput if the mesh is not valid (see `check_mesh`).
  /// \throws SolverError if there is not enough memory for the hierarchy.
  explicit SurfaceQuery(const TriangleMesh& mesh);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  /// Closest point of the surface to `point`. If `point` is not finite (or so far away that its
  /// squared distance is not), triangle is -1 and position and distance are NaN.
  [[nodiscard]] ClosestPoint closest_point(const Eigen::Vector3d& point) const noexcept;

  /// First crossing on the way from `start` to `end`, from either side of the surface; none if
  /// there is no crossing or an end is not finite.
  ///
  /// An end on the surface, within the rounding of its coordinates, is a crossing (so a segment of
  /// zero length hits if it is on the surface); a segment in the plane of a triangle crosses it
  /// only with its ends. A segment 1e15 times as long as the mesh may miss it because of rounding.
  [[nodiscard]] std::optional<SegmentHit> first_hit(const Eigen::Vector3d& start,
                                                    const Eigen::Vector3d& end) const noexcept;

  /// First crossing on the way from the origin along the direction, by the same rules: an origin on
  /// the surface is a crossing at distance 0. Also none if the origin is not finite, the direction
  /// is not finite or zero, or `max_distance` is NaN or negative.
  [[nodiscard]] std::optional<RayHit> first_hit(const Ray& ray) const noexcept;

  /// All crossings on the way from `start` to `end`, from either side of the surface, sorted by
  /// fraction and then by triangle. None if an end is not finite.
  ///
  /// No crossing counts twice: a segment exactly through an edge or a vertex counts as if it passed
  /// beside it, at an infinitesimal distance, to the same side for all triangles. If the surface
  /// goes through there, the segment crosses one of the triangles; at a fold, at which the surface
  /// only touches the segment, two or none (then unlike `first_hit`), and at the border one or
  /// none. A line that begins and ends outside a closed surface therefore crosses it an even number
  /// of times, in turns inwards and outwards if the surface does not intersect itself (if two
  /// crossings are equally far within rounding, in any order). A segment in the plane of a triangle
  /// does not cross it. An end on the surface, within the rounding of its coordinates, is a
  /// crossing at fraction 0 or 1. Allocates the result.
  [[nodiscard]] std::vector<SegmentHit> all_hits(const Eigen::Vector3d& start,
                                                 const Eigen::Vector3d& end) const;

  /// All crossings along the ray by the same rules, from the nearest to the farthest.
  [[nodiscard]] std::vector<RayHit> all_hits(const Ray& ray) const;

  /// Moves the vertices of the mesh; the triangles stay the same. Results equal those of a new
  /// SurfaceQuery. The hierarchy is refitted, which takes a fraction of the time of a new one, or
  /// rebuilt if refitting would make queries much slower. Must not run during queries of other
  /// threads.
  /// \param vertices [mm] 3 x V.
  /// \throws InvalidInput unless there are as many vertices as before, all finite; nothing has then
  /// moved.
  /// \throws SolverError if there is not enough memory to rebuild.
  void move_vertices(const Eigen::Ref<const Eigen::Matrix3Xd>& vertices);

 private:
  std::unique_ptr<SurfaceTree> tree_;
};

/// Closest points of many points; the columns are as in `ClosestPoint`.
struct ClosestPoints {
  Eigen::VectorXi triangles;     ///< N; -1 if there is no closest point
  Eigen::Matrix3Xd barycentric;  ///< 3 x N; 0 if there is no closest point
  Eigen::Matrix3Xd positions;    ///< [mm] 3 x N; NaN if there is no closest point
  Eigen::VectorXd distances;     ///< [mm] N; NaN if there is no closest point
};

/// Computes `closest_point` of each column, using all threads.
/// \param points [mm] 3 x N; a column that is not finite has no closest point.
[[nodiscard]] ClosestPoints closest_points(const SurfaceQuery& query,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// First crossings of many segments or rays.
struct FirstHits {
  Eigen::VectorXi triangles;     ///< N; -1 if there is no crossing
  Eigen::Matrix3Xd barycentric;  ///< 3 x N; 0 if there is no crossing
  Eigen::Matrix3Xd positions;    ///< [mm] 3 x N; NaN if there is no crossing
  Eigen::VectorXd along;  ///< N; fraction of a segment or [mm] along a ray; NaN if there is none
};

/// Computes `first_hit` of each segment, using all threads.
/// \param starts, ends [mm] 3 x N each; a segment with an end that is not finite hits nothing.
/// \throws InvalidInput unless there are as many ends as starts.
[[nodiscard]] FirstHits first_hits(const SurfaceQuery& query,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& starts,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& ends);

/// Computes `first_hit` of each ray, using all threads.
[[nodiscard]] FirstHits first_hits(const SurfaceQuery& query, std::span<const Ray> rays);

/// All crossings of many segments, M in all, in the order of the segments.
struct AllHits {
  Eigen::VectorXi segments;      ///< M; the segment that crosses; ascending
  Eigen::VectorXi triangles;     ///< M
  Eigen::Matrix3Xd barycentric;  ///< 3 x M
  Eigen::Matrix3Xd positions;    ///< [mm] 3 x M
  Eigen::VectorXd along;         ///< M; fraction of the segment; ascending for each segment
};

/// Computes `all_hits` of each segment, using all threads.
/// \param starts, ends [mm] 3 x N each; a segment with an end that is not finite hits nothing.
/// \throws InvalidInput unless there are as many ends as starts.
[[nodiscard]] AllHits all_hits(const SurfaceQuery& query,
                               const Eigen::Ref<const Eigen::Matrix3Xd>& starts,
                               const Eigen::Ref<const Eigen::Matrix3Xd>& ends);

}  // namespace palpate::geometry
