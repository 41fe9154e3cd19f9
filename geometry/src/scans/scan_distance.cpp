// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/scan_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "mesh/triangle_primitives.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

/// The weight of a scan is full this many edges from its border, and a part of one there.
constexpr int kFeatherEdges = 4;
/// Beyond the border, the tangent plane is a guess, a poor one if the scan is noisy. At this part
/// of the overhang its weight is a quarter, and it falls with the fourth power, so that it counts
/// only where no scan has measured.
constexpr double kGuess = 0.25;

Eigen::Matrix3Xd zero_for_nan(const Eigen::Matrix3Xd& normals) {
  return normals.array().isNaN().select(0, normals);
}

/// Pseudonormals of the vertices, of any length: the normals of their triangles, weighted by the
/// angles there.
Eigen::Matrix3Xd pseudonormals(const TriangleMesh& mesh, const Eigen::Matrix3Xd& of_triangles) {
  Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corners = mesh.triangles.col(t);
    const Eigen::Vector3d a = mesh.vertices.col(corners[0]);
    const Eigen::Vector3d ab = mesh.vertices.col(corners[1]) - a;
    const Eigen::Vector3d ac = mesh.vertices.col(corners[2]) - a;
    const double area = of_triangles.col(t).dot(ab.cross(ac));
    const double at_a = std::atan2(area, ab.dot(ac));
    const double at_b = std::atan2(area, ab.dot(ab - ac));
    const Eigen::Vector3d angles(at_a, at_b, std::numbers::pi - at_a - at_b);
    for (int k = 0; k < 3; ++k) sums.col(corners[k]) += angles[k] * of_triangles.col(t);
  }
  return sums;
}

/// For each vertex the number of edges to the border, at most kFeatherEdges.
Eigen::VectorXi edges_to_border(const TriangleMesh& mesh, const Eigen::Matrix3Xi& opposite) {
  Eigen::VectorXi edges = Eigen::VectorXi::Constant(mesh.vertices.cols(), kFeatherEdges);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (opposite(k, t) >= 0) continue;
      edges[mesh.triangles(k, t)] = 0;
      edges[mesh.triangles((k + 1) % 3, t)] = 0;
    }
  }
  for (int ring = 1; ring < kFeatherEdges; ++ring) {
    for (const auto& t : mesh.triangles.colwise()) {
      const int least = std::min({edges[t[0]], edges[t[1]], edges[t[2]]});
      if (least != ring - 1) continue;
      for (const int v : t) edges[v] = std::min(edges[v], ring);
    }
  }
  return edges;
}

}  // namespace

ScanDistance::ScanDistance(TriangleMesh mesh, const Eigen::VectorXd& sigma, double overhang)
    : mesh_(std::move(mesh)),
      opposite_(opposite_half_edges(mesh_)),
      triangle_normals_(zero_for_nan(geometry::triangle_normals(mesh_))),
      vertex_normals_(pseudonormals(mesh_, triangle_normals_)),
      overhang_(overhang) {
  const Eigen::VectorXi edges = edges_to_border(mesh_, opposite_);
  for (const int e : edges) at_border_.push_back(e == 0);
  feather_ = (edges.cast<double>().array() + 1) / (kFeatherEdges + 1);
  if (sigma.size() > 0) {
    precision_ = sigma.array().square().inverse();
  } else {
    precision_.setOnes(mesh_.vertices.cols());
  }
}

ScanDistance::Side ScanDistance::side_at(int triangle, const Eigen::Vector3d& barycentric) const {
  const auto corners = mesh_.triangles.col(triangle);
  const auto zeros = (barycentric.array() == 0).count();
  Eigen::Index k = 0;
  if (zeros == 2) {
    barycentric.maxCoeff(&k);
    return {.outward = vertex_normals_.col(corners[k]),
            .border = at_border_[static_cast<std::size_t>(corners[k])]};
  }
  const Eigen::Vector3d here = triangle_normals_.col(triangle);
  if (zeros == 0) return {.outward = here};
  barycentric.minCoeff(&k);
  const int opposite = opposite_((k + 1) % 3, triangle);  // of the edge that faces corner k
  if (opposite < 0) return {.outward = here, .border = true};
  return {.outward = here + triangle_normals_.col(opposite / 3)};
}

PlaceDistance ScanDistance::at(const Eigen::Vector3d& place, NearTriangle near) const {
  const auto named = mesh_.triangles.col(near.triangle);
  const Corners corners = {mesh_.vertices.col(named[0]), mesh_.vertices.col(named[1]),
                           mesh_.vertices.col(named[2])};
  const Eigen::Vector3d b = near.corner < 0 ? nearest_on_triangle(place, corners).barycentric
                                            : Eigen::Vector3d(Eigen::Vector3d::Unit(near.corner));
  const Side side = side_at(near.triangle, b);
  const double length = side.outward.norm();
  if (length == 0) return {};
  const Eigen::Vector3d way = place - point_on(corners, b);
  const double height = side.outward.dot(way) / length;
  PlaceDistance there;
  if (side.border) {
    there.beyond = std::sqrt(std::max(0.0, way.squaredNorm() - height * height));
    if (there.beyond > overhang_) return {};
    there.distance = height;
  } else {
    there.distance = std::copysign(way.norm(), height);
  }
  there.precision = b.dot(precision_(named));
  // The overhang may be 0.
  const double guess = there.beyond > 0 ? there.beyond / (kGuess * overhang_) : 0;
  const double doubt = 1 + guess * guess;
  there.weight = there.precision * b.dot(feather_(named)) / (doubt * doubt);
  return there;
}

}  // namespace palpate::geometry
