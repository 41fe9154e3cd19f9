// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/contact_motion.h"
#include "playback/surface_walk.h"

namespace palpate::haptics {

/// On which side of a surface a tool is, and where it touches. Real-time safe after construction.
class SurfaceSide {
 public:
  /// \param query of the same surface; must outlive this.
  SurfaceSide(const geometry::TriangleMesh& surface, const geometry::SurfaceQuery& query);

  [[nodiscard]] const SurfaceWalk& walk() const noexcept { return walk_; }
  /// \param fallback normal of a triangle without area.
  [[nodiscard]] TouchPoint touch_point(const SurfacePlace& place,
                                       const Eigen::Vector3d& fallback) const noexcept;
  /// Returns true if the path to the tool enters the surface from outside, and finds where.
  [[nodiscard]] bool enters(const Eigen::Vector3d& from, const Eigen::Vector3d& tool,
                            TouchPoint& contact) const noexcept;
  /// A point outside the surface and next to a contact, in front of all triangles that it touches.
  [[nodiscard]] Eigen::Vector3d lifted(const TouchPoint& contact) const noexcept;
  /// Returns true if a tool that touched still touches.
  [[nodiscard]] bool stays(const TouchPoint& contact, const Eigen::Vector3d& tool) const noexcept;
  /// [mm] from the nearest part of the surface to the tool, in front of it > 0 and behind it < 0; 0
  /// beyond the border.
  [[nodiscard]] double signed_distance(const Eigen::Vector3d& tool,
                                       TouchPoint& nearest) const noexcept;

 private:
  SurfaceWalk walk_;
  const geometry::SurfaceQuery& query_;
  double offset_;  // [mm]

  [[nodiscard]] Eigen::Vector3d centroid(int triangle) const noexcept;
};

}  // namespace palpate::haptics
