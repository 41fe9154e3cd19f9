// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <span>

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
  double fraction = 0;  ///< where along the segment, 0 at its start, 1 at its end
};

/// A half-line, or the part of it up to a distance.
struct Ray {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();               ///< [mm]
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();            ///< of any length but 0
  double max_distance = std::numeric_limits<double>::infinity();  ///< [mm] >= 0
};

struct RayHit {
  SurfacePoint at;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
  double distance = 0;                                 ///< [mm] from the origin
};

/// Answers geometric questions about one mesh through a bounding volume hierarchy (built by
/// Embree).
///
/// The hierarchy only culls, in single precision on the centred and scaled mesh and with a margin
/// for its rounding; the triangles that are left are compared in double. So the answers are those
/// of a search through all triangles in double, and a mesh 1 km from the origin answers as well as
/// one at it. Of triangles that answer equally well the one with the lowest index is named. Queries
/// are const, thread-safe, do not allocate and do not throw (those of many points at once allocate
/// their answers).
class SurfaceQuery {
 public:
  /// \throws InvalidInput if the mesh is not valid (see `check_mesh`); SolverError if there is not
  /// the memory for the hierarchy.
  explicit SurfaceQuery(const TriangleMesh& mesh);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  /// The point of the surface nearest to `point`; triangle = -1, position and distance NaN if
  /// `point` is not finite (or so far away that the square of its distance is not).
  [[nodiscard]] ClosestPoint closest_point(const Eigen::Vector3d& point) const noexcept;

  /// The first crossing on the way from `start` to `end`, from either side of the surface; none if
  /// there is no crossing or an end is not finite. An end on the surface, within the rounding of
  /// its coordinates, is a crossing (so a segment without length hits iff it is on the surface); a
  /// segment within the plane of a triangle crosses it only with its ends. A segment 1e15 times as
  /// long as the mesh is lost in its own rounding and may miss it.
  [[nodiscard]] std::optional<SegmentHit> first_hit(const Eigen::Vector3d& start,
                                                    const Eigen::Vector3d& end) const noexcept;

  /// The first crossing on the way from the origin along the direction, by the rules of a segment:
  /// an origin on the surface is a crossing at distance 0. None too if the origin is not finite,
  /// the direction is not finite or zero, or `max_distance` is NaN or negative.
  [[nodiscard]] std::optional<RayHit> first_hit(const Ray& ray) const noexcept;

  /// The mesh deforms: its vertices are elsewhere, its triangles the same. Answers are those of a
  /// new SurfaceQuery. The hierarchy is fitted to the new places, which takes a fraction of the
  /// time of a new one; when that would leave it much slower to walk than it was, it is built anew.
  /// Not while another thread asks. \param vertices [mm] 3 x V. \throws InvalidInput unless there
  /// are as many vertices as before, all finite; then nothing has moved. SolverError if there is
  /// not the memory to build anew.
  void move_vertices(const Eigen::Ref<const Eigen::Matrix3Xd>& vertices);

 private:
  std::unique_ptr<SurfaceTree> tree_;
};

/// Closest points of many; the columns are as in `ClosestPoint`.
struct ClosestPoints {
  Eigen::VectorXi triangles;     ///< N; -1 for a point that has none
  Eigen::Matrix3Xd barycentric;  ///< 3 x N; 0 for a point that has none
  Eigen::Matrix3Xd positions;    ///< [mm] 3 x N; NaN for a point that has none
  Eigen::VectorXd distances;     ///< [mm] N; NaN for a point that has none
};

/// `closest_point` of each column, on all threads.
/// \param points [mm] 3 x N; a column that is not finite has no closest point.
[[nodiscard]] ClosestPoints closest_points(const SurfaceQuery& query,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// First crossings of many segments or rays.
struct FirstHits {
  Eigen::VectorXi triangles;     ///< N; -1 where there is none
  Eigen::Matrix3Xd barycentric;  ///< 3 x N; 0 where there is none
  Eigen::Matrix3Xd positions;    ///< [mm] 3 x N; NaN where there is none
  Eigen::VectorXd along;  ///< N; fraction of a segment, [mm] along a ray; NaN where there is none
};

/// `first_hit` of each segment, on all threads.
/// \param starts, ends [mm] 3 x N each; a segment whose end is not finite hits nothing.
/// \throws InvalidInput unless there are as many ends as starts.
[[nodiscard]] FirstHits first_hits(const SurfaceQuery& query,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& starts,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& ends);

/// `first_hit` of each ray, on all threads.
[[nodiscard]] FirstHits first_hits(const SurfaceQuery& query, std::span<const Ray> rays);

}  // namespace palpate::geometry
