// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/scan_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "palpate/core/parallel_for.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

/// The weight of a scan is full this many edges from its border, and a part of one there.
constexpr int kFeatherEdges = 4;
/// Beyond the border, the tangent plane is a guess, a poor one if the scan is noisy. At this part
/// of the overhang its weight is a quarter, and it falls with the fourth power, so that it counts
/// only where no scan has measured.
constexpr double kGuess = 0.25;
/// A place is evaluated in about a microsecond: enough of them for a task.
constexpr std::ptrdiff_t kPlacesATask = 256;

Eigen::Matrix3Xd zero_for_nan(const Eigen::Matrix3Xd& normals) {
  return normals.array().isNaN().select(0, normals);
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

ScanDistance::ScanDistance(const TriangleMesh& mesh, const Eigen::VectorXd& sigma, double overhang)
    : mesh_(mesh),
      query_(mesh),
      opposite_(opposite_half_edges(mesh)),
      triangle_normals_(zero_for_nan(geometry::triangle_normals(mesh))),
      vertex_normals_(zero_for_nan(geometry::vertex_normals(mesh))),
      overhang_(overhang) {
  const Eigen::VectorXi edges = edges_to_border(mesh, opposite_);
  for (const int e : edges) at_border_.push_back(e == 0);
  feather_ = (edges.cast<double>().array() + 1) / (kFeatherEdges + 1);
  if (sigma.size() > 0) {
    precision_ = sigma.array().square().inverse();
  } else {
    precision_.setOnes(mesh.vertices.cols());
  }
}

ScanDistance::Side ScanDistance::side_at(const SurfacePoint& at) const {
  const auto corners = mesh_.triangles.col(at.triangle);
  const auto zeros = (at.barycentric.array() == 0).count();
  Eigen::Index k = 0;
  if (zeros == 2) {
    at.barycentric.maxCoeff(&k);
    return {.outward = vertex_normals_.col(corners[k]),
            .border = at_border_[static_cast<std::size_t>(corners[k])]};
  }
  const Eigen::Vector3d here = triangle_normals_.col(at.triangle);
  if (zeros == 0) return {.outward = here};
  at.barycentric.minCoeff(&k);
  const int opposite = opposite_((k + 1) % 3, at.triangle);  // of the edge that faces corner k
  if (opposite < 0) return {.outward = here, .border = true};
  return {.outward = here + triangle_normals_.col(opposite / 3)};
}

PlaceDistances ScanDistance::at(const Eigen::Ref<const Eigen::Matrix3Xd>& places) const {
  PlaceDistances result{.distance = Eigen::VectorXd::Zero(places.cols()),
                        .weight = Eigen::VectorXd::Zero(places.cols()),
                        .beyond = Eigen::VectorXd::Zero(places.cols()),
                        .precision = Eigen::VectorXd::Zero(places.cols())};
  parallel_ranges(places.cols(), kPlacesATask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      const ClosestPoint closest = query_.closest_point(places.col(i));
      const Side side = side_at(closest.at);
      const double length = side.outward.norm();
      if (length == 0) continue;
      const Eigen::Vector3d way = places.col(i) - closest.position;
      const double height = side.outward.dot(way) / length;
      if (side.border) {
        result.beyond[i] = std::sqrt(std::max(0.0, way.squaredNorm() - height * height));
        if (result.beyond[i] > overhang_) continue;
        result.distance[i] = height;
      } else {
        result.distance[i] = std::copysign(closest.distance, height);
      }
      const auto corners = mesh_.triangles.col(closest.at.triangle);
      const Eigen::Vector3d& b = closest.at.barycentric;
      result.precision[i] = b.dot(precision_(corners));
      // The overhang may be 0.
      const double guess = result.beyond[i] > 0 ? result.beyond[i] / (kGuess * overhang_) : 0;
      const double doubt = 1 + guess * guess;
      result.weight[i] = result.precision[i] * b.dot(feather_(corners)) / (doubt * doubt);
    }
  });
  return result;
}

Eigen::VectorXd ScanDistance::unsigned_at(const Eigen::Ref<const Eigen::Matrix3Xd>& places) const {
  Eigen::VectorXd distances(places.cols());
  parallel_ranges(places.cols(), kPlacesATask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i)
      distances[i] = query_.closest_point(places.col(i)).distance;
  });
  return distances;
}

}  // namespace palpate::geometry
