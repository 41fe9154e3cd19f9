// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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
/// The mesh is centred and scaled before it goes into single precision, and every answer is computed
/// again in double on the triangle that was found: a mesh 1 km from the origin answers as well as one
/// at it. Queries are const, thread-safe, do not allocate and do not throw.
class SurfaceQuery {
 public:
  /// \throws InvalidInput if the mesh is not valid (see `check_mesh`).
  explicit SurfaceQuery(const TriangleMesh& mesh);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  /// The point of the surface nearest to `point`; triangle = -1 and distance = NaN if `point` is not finite.
  [[nodiscard]] ClosestPoint closest_point(const Eigen::Vector3d& point) const noexcept;

  /// The first crossing on the way from `start` to `end`, from either side of the surface; none if
  /// there is no crossing or an end is not finite.
  [[nodiscard]] std::optional<SegmentHit> first_hit(const Eigen::Vector3d& start,
                                                    const Eigen::Vector3d& end) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::geometry
