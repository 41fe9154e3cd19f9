// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/facing_share.h"

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include "mesh/triangle_fans.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

/// Finds the vertices around places; its memory serves all of them.
class BallWalk {
 public:
  BallWalk(const TriangleMesh& mesh, double radius)
      : mesh_(mesh),
        squared_(radius * radius),
        half_edges_(half_edges_by_vertex(mesh, first_)),
        seen_by_(static_cast<size_t>(mesh.vertices.cols()), -1) {}

  /// Calls `visit(t)` with the triangles at each of those vertices.
  template <typename Visit>
  void around(const SurfacePoint& place, Eigen::Index number, const Visit& visit) {
    const Eigen::Vector3d centre = position(mesh_, place);
    found_.clear();
    const auto find = [&](int vertex) {
      if (std::exchange(seen_by_[static_cast<size_t>(vertex)], number) != number)
        found_.push_back(vertex);
    };
    for (int k = 0; k < 3; ++k)
      if (place.barycentric[k] > 0) find(mesh_.triangles(k, place.triangle));
    for (size_t i = 0; i < found_.size(); ++i) {
      const auto at = static_cast<size_t>(found_[i]);
      for (int h = first_[at]; h < first_[at + 1]; ++h) {
        const int triangle = half_edges_[static_cast<size_t>(h)] / 3;
        visit(triangle);
        for (const int corner : mesh_.triangles.col(triangle))
          if ((mesh_.vertices.col(corner) - centre).squaredNorm() <= squared_) find(corner);
      }
    }
  }

 private:
  const TriangleMesh& mesh_;
  double squared_;
  std::vector<int> first_, half_edges_;
  std::vector<Eigen::Index> seen_by_;
  std::vector<int> found_;
};

}  // namespace

Eigen::VectorXd facing_shares(const TriangleMesh& mesh, std::span<const SurfacePoint> places,
                              const Eigen::Ref<const Eigen::Matrix3Xd>& directions, double radius) {
  check_mesh(mesh, "facing_shares()");
  require("facing_shares(): radius", radius, at_least(0), "mm");
  if (directions.cols() != static_cast<Eigen::Index>(places.size())) {
    throw InvalidInput("facing_shares(): there are " + std::to_string(places.size()) +
                       " places and " + std::to_string(directions.cols()) +
                       " directions; pass one of each");
  }
  BallWalk walk(mesh, radius);
  Eigen::VectorXd shares(directions.cols());
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    const SurfacePoint& place = places[static_cast<size_t>(i)];
    check_surface_point(mesh, place, "facing_shares()");
    double towards = 0, away = 0;
    walk.around(place, i, [&](int triangle) {
      const Eigen::Vector3i corners = mesh.triangles.col(triangle);
      const Eigen::Vector3d a = mesh.vertices.col(corners[0]);
      const Eigen::Vector3d normal =
          (mesh.vertices.col(corners[1]) - a).cross(mesh.vertices.col(corners[2]) - a);
      const double facing = normal.dot(directions.col(i));
      if (facing > 0) towards += normal.norm();
      if (facing < 0) away += normal.norm();
    });
    shares[i] = towards / (towards + away);
  }
  return shares;
}

}  // namespace palpate::geometry
