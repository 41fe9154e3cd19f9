// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <mutex>
#include <vector>

#include "palpate/geometry/registration.h"
#include "query/local_frame.h"
#include "query/surface_tree.h"
#include "registration/rigid_step.h"
#include "registration/surfel_grid.h"

// All data are in the local frame: the target centred on its bounding box and scaled by a power of
// two to about [-1, 1].

namespace palpate::geometry {

class VertexCloud;  // registration_pcl.h

struct RegistrationTarget::Impl {
  Impl(const TriangleMesh& mesh, TreeBuild build);
  ~Impl();

  /// Nearest points of the surface. A point is beside the surface if its nearest point is on the
  /// border.
  [[nodiscard]] Pairing pair(const Eigen::Matrix3Xd& points) const;
  /// Approximation from the coarse map, in constant time.
  void pair_coarsely(const Eigen::Matrix3Xd& points, Pairing& pairing) const;
  [[nodiscard]] const VertexCloud& vertex_cloud() const;  ///< created at the first call

  [[nodiscard]] Eigen::Isometry3d to_world(const Eigen::Isometry3d& local) const;

  Eigen::Vector3d centre;
  double scale;              ///< local = (world - centre) * scale
  TriangleMesh mesh;         ///< local frame
  double diagonal;           ///< local frame
  Eigen::Matrix3Xd normals;  ///< of the triangles
  SurfaceTree tree;
  SurfelGrid grid;

 private:
  Impl(const TriangleMesh& surface, const LocalFrame& frame, TreeBuild build);
  void find_border();
  [[nodiscard]] bool is_on_border(const SurfacePoint& foot) const;

  std::vector<bool> border_sides_;  ///< side k of triangle t: 3 t + k, from corner k to the next
  std::vector<bool> border_vertices_;
  mutable std::once_flag cloud_made_;
  mutable std::unique_ptr<const VertexCloud> cloud_;
};

}  // namespace palpate::geometry
