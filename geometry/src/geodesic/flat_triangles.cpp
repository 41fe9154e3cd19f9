// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/flat_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/numbers.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

/// Paths bend at a vertex iff the angle of the surface there exceeds a full one (a straight one on
/// the border) by this fraction. A smaller excess changes a length by no more than this fraction.
constexpr double kExcessAngle = 1e-12;

double power_of_two_unit(const TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  const double largest =
      std::max(box.max().cwiseMax(-box.min()).maxCoeff(), std::numeric_limits<double>::min());
  return std::exp2(-std::ilogb(largest));
}

void refuse_triangles_without_area(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xd normals = triangle_normals(mesh);
  for (Eigen::Index t = 0; t < normals.cols(); ++t) {
    if (normals.col(t).allFinite()) continue;
    throw InvalidInput("geodesic_distance: triangle " + std::to_string(t) +
                       " has no area, which exact distances cannot pass; remove it, or use fast "
                       "marching");
  }
}

/// The direction of a vector in the half-plane above an axis.
Eigen::Vector2d direction_above(const Eigen::Vector3d& axis, const Eigen::Vector3d& vector) {
  const Eigen::Vector3d x = axis.stableNormalized();
  const Eigen::Vector3d d = vector.stableNormalized();
  return Eigen::Vector2d(x.dot(d), x.cross(d).norm()).normalized();
}

void sort_by_start(FlatTriangles& flat, Eigen::Index vertex_count) {
  flat.first_leaving.assign(static_cast<size_t>(vertex_count) + 1, 0);
  for (const FlatHalfEdge& half_edge : flat.half_edges) {
    ++flat.first_leaving[static_cast<size_t>(half_edge.start) + 1];
  }
  for (size_t v = 1; v < flat.first_leaving.size(); ++v) {
    flat.first_leaving[v] += flat.first_leaving[v - 1];
  }
  flat.leaving.resize(flat.half_edges.size());
  std::vector<int> free(flat.first_leaving.begin(), flat.first_leaving.end() - 1);
  for (int h = 0; h < static_cast<int>(flat.half_edges.size()); ++h) {
    flat.leaving[static_cast<size_t>(free[static_cast<size_t>(flat[h].start)]++)] = h;
  }
}

bool bends_at(const FlatTriangles& flat, std::span<const int> leaving) {
  if (leaving.empty()) return false;
  const auto on_border = std::find_if(leaving.begin(), leaving.end(),
                                      [&](int h) { return flat[h].opposite == kNone; });
  const bool is_border = on_border != leaving.end();
  const int first = is_border ? *on_border : leaving.front();
  double angle = 0;
  double shortest = kInfinity;
  double longest = 0;
  size_t fan = 0;  // triangles
  for (int h = first; h != kNone && (fan == 0 || h != first); ++fan) {
    angle += std::atan2(flat[h].left.y(), flat[h].left.x());
    for (const double length : {flat[h].length, flat[last_half_edge(h)].length}) {
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
    h = flat[last_half_edge(h)].opposite;
  }
  const bool is_between_fans = fan < leaving.size();
  const double straight = (is_border ? 1 : 2) * std::numbers::pi;
  return is_between_fans || angle > straight * (1 + kExcessAngle) || shortest < kClose * longest;
}

}  // namespace

FlatTriangles flat_triangles(const TriangleMesh& mesh) {
  refuse_triangles_without_area(mesh);
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  FlatTriangles flat;
  flat.unit = power_of_two_unit(mesh);
  flat.half_edges.resize(static_cast<size_t>(mesh.triangles.size()));
  double sum = 0;
  for (int h = 0; h < mesh.triangles.size(); ++h) {
    const int k = h % 3;
    const auto corner = [&](int i) -> Eigen::Vector3d {
      return flat.unit * mesh.vertices.col(mesh.triangles((k + i) % 3, h / 3));
    };
    const Eigen::Vector3d edge = corner(1) - corner(0);
    FlatHalfEdge& half_edge = flat.half_edges[static_cast<size_t>(h)];
    half_edge.length = std::hypot(edge.x(), edge.y(), edge.z());
    half_edge.left = direction_above(edge, corner(2) - corner(0));
    half_edge.right = direction_above(-edge, corner(2) - corner(1));
    half_edge.opposite = opposite(k, h / 3);
    half_edge.along_edge = half_edge.opposite == kNone || h < half_edge.opposite;
    half_edge.edge = half_edge.along_edge ? flat.edge_count++ : flat[half_edge.opposite].edge;
    half_edge.start = mesh.triangles(k, h / 3);
    sum += half_edge.length;
  }
  flat.mean_length = sum / static_cast<double>(flat.half_edges.size());
  sort_by_start(flat, mesh.vertices.cols());
  flat.bends.resize(static_cast<size_t>(mesh.vertices.cols()));
  for (int v = 0; v < mesh.vertices.cols(); ++v) {
    flat.bends[static_cast<size_t>(v)] = bends_at(flat, flat.from(v)) ? 1 : 0;
  }
  return flat;
}

}  // namespace palpate::geometry
