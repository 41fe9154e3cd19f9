// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "palpate/core/work_steps.h"
#include "palpate/geometry/registration.h"
#include "query/local_frame.h"
#include "query/surface_tree.h"
#include "registration/rigid_step.h"
#include "registration/surfel_grid.h"

// All data are in the local frame: the target centred on its bounding box and scaled by a power of
// two to about [-1, 1].

namespace palpate::geometry {

class VertexCloud;  // registration_pcl.h

/// Result of the last search for the nearest triangle of a point, with lengths in the frame of the
/// tree.
struct TrackedTriangle {
  Corners corners;
  Eigen::Vector3d searched_at;  ///< position of the point then
  double others = 0;            ///< no other triangle was nearer than this then
  int triangle = -1;            ///< -1 if there is none
  int place = -1;               ///< in the tree
};

/// A pairing, and data that often save the search when its points are paired again after a small
/// motion.
struct TrackedPairing {
  Pairing pairing;
  std::vector<TrackedTriangle> triangles;
};

/// Intended use of a target.
enum class TargetUse { once, often };

struct RegistrationTarget::Impl {
  /// \param standoff_mm see RegistrationTarget
  Impl(const TriangleMesh& mesh, TargetUse use, double standoff_mm = 0);
  ~Impl();

  /// Nearest points of the surface. A point is beside the surface if its nearest point is on the
  /// border. With a standoff, the planes are those of the surface in this distance, and across the
  /// way from the nearest point of the surface itself.
  [[nodiscard]] Pairing pair(const Eigen::Matrix3Xd& points, WorkSteps& steps) const;
  [[nodiscard]] Pairing pair(const Eigen::Matrix3Xd& points) const;
  /// The same for points that move in small steps.
  /// \param slack other triangles are searched up to this much farther away than the nearest.
  /// With about twice the length of the next motions, few of these need a search.
  /// \param tracked the pairing before; empty at first.
  /// \param steps are told, after some thousands of points each, that the task is still running.
  void pair(const Eigen::Matrix3Xd& points, double slack, TrackedPairing& tracked,
            WorkSteps& steps) const;
  /// Approximation from the coarse map, in constant time.
  void pair_coarsely(const Eigen::Matrix3Xd& points, Pairing& pairing) const;
  [[nodiscard]] const SurfelGrid& grid() const;  ///< the coarse map, for `once` made at first use
  [[nodiscard]] const VertexCloud& vertex_cloud() const;  ///< created at the first call

  [[nodiscard]] Eigen::Isometry3d to_world(const Eigen::Isometry3d& local) const;

  Eigen::Vector3d centre;
  double scale;      ///< local = (world - centre) * scale
  SurfaceTree tree;  ///< of the target in the local frame
  double diagonal;   ///< local frame
  double standoff;   ///< local frame

 private:
  Impl(const TriangleMesh& surface, const LocalFrame& frame, TargetUse use, double standoff_mm);
  void find_border();
  [[nodiscard]] Nearest search(const Eigen::Vector3d& point, int guess, double slack,
                               TrackedTriangle& tracked) const;
  [[nodiscard]] bool is_on_border(const SurfacePoint& foot) const;

  mutable std::once_flag grid_made_;
  mutable std::optional<SurfelGrid> grid_;
  std::vector<bool> border_sides_;  ///< side k of triangle t: 3 t + k, from corner k to the next
  std::vector<bool> border_vertices_;
  mutable std::once_flag cloud_made_;
  mutable std::unique_ptr<const VertexCloud> cloud_;
};

}  // namespace palpate::geometry
