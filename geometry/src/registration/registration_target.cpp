// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/registration_target.h"

#include <cmath>
#include <span>

#include "base/numbers.h"
#include "mesh/edge_table.h"
#include "palpate/error.h"
#include "palpate/parallel_for.h"
#include "registration/registration_pcl.h"

namespace palpate::geometry {
namespace {

/// Points per task.
constexpr Eigen::Index kPointsPerTask = 64;

/// On the coarse map, a point more than two cells away is beside the surface iff at most this share
/// of the way to it is along the normal.
constexpr double kAlongNormal = 0.7;

const TriangleMesh& checked(const TriangleMesh& mesh) {
  check_mesh(mesh, "register_points: the target");
  if (!(triangle_normals(mesh).array() == triangle_normals(mesh).array()).any()) {
    throw InvalidInput(
        "register_points: the target: no triangle has an area; a surface is needed to register to");
  }
  return mesh;
}

}  // namespace

RegistrationTarget::Impl::Impl(const TriangleMesh& surface, TreeBuild build)
    : Impl(surface, local_frame(checked(surface).vertices), build) {}

RegistrationTarget::Impl::Impl(const TriangleMesh& surface, const LocalFrame& frame,
                               TreeBuild build)
    : centre(frame.centre),
      scale(frame.scale),
      mesh{.vertices = frame.to_local(surface.vertices), .triangles = surface.triangles},
      diagonal(bounding_diagonal(mesh)),
      normals(triangle_normals(mesh)),
      tree(mesh, build),
      grid(mesh) {
  find_border();
}

RegistrationTarget::Impl::~Impl() = default;

void RegistrationTarget::Impl::find_border() {
  border_sides_.assign(static_cast<size_t>(mesh.triangles.size()), false);
  border_vertices_.assign(static_cast<size_t>(mesh.vertices.cols()), false);
  for_each_edge(sort_sides(mesh.triangles), [&](std::span<const EdgeSide> sides) {
    if (sides.size() != 1) return;
    border_sides_[static_cast<size_t>(sides[0].half_edge)] = true;
    border_vertices_[static_cast<size_t>(sides[0].low)] = true;
    border_vertices_[static_cast<size_t>(sides[0].high)] = true;
  });
}

bool RegistrationTarget::Impl::is_on_border(const SurfacePoint& foot) const {
  for (int k = 0; k < 3; ++k) {
    if (foot.barycentric[(k + 2) % 3] > 0) continue;
    if (border_sides_[static_cast<size_t>(3 * foot.triangle + k)]) return true;
    // At a corner of this side the border may belong to other triangles.
    for (const int corner : {k, (k + 1) % 3}) {
      if (foot.barycentric[corner] == 1 &&
          border_vertices_[static_cast<size_t>(mesh.triangles(corner, foot.triangle))]) {
        return true;
      }
    }
  }
  return false;
}

Pairing RegistrationTarget::Impl::pair(const Eigen::Matrix3Xd& points) const {
  Pairing pairing;
  pairing.resize(points.cols());
  parallel_ranges(points.cols(), kPointsPerTask, [&](Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index i = begin; i < end; ++i) {
      const Eigen::Vector3d point = tree.to_local(points.col(i));
      const NearestTriangle nearest =
          point.allFinite() ? tree.nearest(point, kInfinity) : NearestTriangle{};
      if (nearest.triangle < 0) {  // so far away that the distance overflows
        pairing.feet.col(i).setConstant(kNan);
        pairing.distances[i] = kInfinity;
        pairing.usable[i] = false;
        continue;
      }
      pairing.feet.col(i) = tree.position(nearest.place, nearest.at.barycentric);
      pairing.distances[i] = std::sqrt(nearest.at.squared_distance) / tree.scale();
      pairing.normals.col(i) = normals.col(nearest.triangle);
      pairing.usable[i] =
          pairing.normals.col(i).allFinite() &&
          !is_on_border({.triangle = nearest.triangle, .barycentric = nearest.at.barycentric});
    }
  });
  return pairing;
}

void RegistrationTarget::Impl::pair_coarsely(const Eigen::Matrix3Xd& points,
                                             Pairing& pairing) const {
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Surfel& surfel = grid.nearest(points.col(i));
    const Eigen::Vector3d foot = surfel.position.cast<double>();
    const Eigen::Vector3d normal = surfel.normal.cast<double>();
    const Eigen::Vector3d way = points.col(i) - foot;
    const double along = std::abs(normal.dot(way));
    const double distance = way.norm();
    const bool is_far = distance > 2 * grid.cell_size();
    pairing.feet.col(i) = foot;
    pairing.normals.col(i) = normal;
    // At close range the surfel's plane approximates the surface better than its centre.
    pairing.distances[i] = is_far ? distance : along;
    pairing.usable[i] = !is_far || along > kAlongNormal * distance;
  }
}

const VertexCloud& RegistrationTarget::Impl::vertex_cloud() const {
  std::call_once(cloud_made_, [this] { cloud_ = std::make_unique<const VertexCloud>(mesh); });
  return *cloud_;
}

Eigen::Isometry3d RegistrationTarget::Impl::to_world(const Eigen::Isometry3d& local) const {
  Eigen::Isometry3d world = local;
  world.translation() = centre + local.translation() / scale - local.linear() * centre;
  return world;
}

RegistrationTarget::RegistrationTarget(const TriangleMesh& mesh)
    : impl_(std::make_shared<const Impl>(mesh, TreeBuild::thorough)) {}

}  // namespace palpate::geometry
