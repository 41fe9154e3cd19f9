// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

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

/// Answers geometric questions about one mesh through a bounding volume hierarchy (Embree).
///
/// The hierarchy only culls, in single precision on the centred and scaled mesh and with a margin
/// for its rounding; the triangles that are left are compared in double. So the answers are those
/// of a search through all triangles in double, and a mesh 1 km from the origin answers as well as
/// one at it. Of triangles that answer equally well the one with the lowest index is named. Queries
/// are const, thread-safe, do not allocate and do not throw.
class SurfaceQuery {
 public:
  /// \throws InvalidInput if the mesh is not valid (see `check_mesh`).
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

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::geometry
