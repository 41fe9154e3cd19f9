// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/surface_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

// A walk begins this much of the way from its place to the centroid of the triangle, and therefore
// inside it, even at a vertex. Then the plane cuts exactly two edges of every triangle on the way.
constexpr double kTowardsCentroid = 1e-9;

constexpr std::size_t next_corner(std::size_t corner) { return corner == 2 ? 0 : corner + 1; }

}  // namespace

SurfaceWalk::SurfaceWalk(const geometry::TriangleMesh& surface)
    : size_(geometry::bounding_diagonal(surface)) {
  for (const auto& vertex : surface.vertices.colwise()) vertices_.emplace_back(vertex);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(surface);
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const auto corners = surface.triangles.col(t);
    triangles_.push_back({.corners = {corners[0], corners[1], corners[2]},
                          .neighbours = {-1, -1, -1},
                          .normal = normals.col(t)});
  }
  connect();
}

// Sorts the edges by their lower vertex, by counting, and joins pairs.
void SurfaceWalk::connect() {
  struct Edge {
    int other, triangle, corner;
    bool rising;  // from the lower to the higher vertex
  };
  std::vector<std::size_t> first(vertices_.size() + 1, 0);
  const auto for_each_edge = [&](auto&& use) {
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = triangles_[t].corners[k], b = triangles_[t].corners[next_corner(k)];
        use(static_cast<std::size_t>(std::min(a, b)),
            Edge{std::max(a, b), static_cast<int>(t), static_cast<int>(k), a < b});
      }
    }
  };
  for_each_edge([&](std::size_t lower, const Edge&) { ++first[lower + 1]; });
  for (std::size_t v = 0; v < vertices_.size(); ++v) first[v + 1] += first[v];
  std::vector<Edge> edges(3 * triangles_.size());
  std::vector<std::size_t> end(first.begin(), first.end() - 1);
  for_each_edge([&](std::size_t lower, const Edge& edge) { edges[end[lower]++] = edge; });
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    for (std::size_t i = first[v]; i < first[v + 1]; ++i) {
      int others = 0;
      std::size_t partner = i;
      for (std::size_t j = first[v]; j < first[v + 1]; ++j) {
        if (j == i || edges[j].other != edges[i].other) continue;
        ++others;
        partner = j;
      }
      if (others != 1 || edges[partner].rising == edges[i].rising) continue;
      triangles_[static_cast<std::size_t>(edges[i].triangle)]
          .neighbours[static_cast<std::size_t>(edges[i].corner)] = edges[partner].triangle;
    }
  }
}

const Eigen::Vector3d& SurfaceWalk::corner(int triangle, int corner) const noexcept {
  const Triangle& t = triangles_[static_cast<std::size_t>(triangle)];
  return vertices_[static_cast<std::size_t>(t.corners[static_cast<std::size_t>(corner)])];
}

// Ericson 2005, section 3.4.
geometry::SurfacePoint SurfaceWalk::point(const SurfacePlace& place) const noexcept {
  const Eigen::Vector3d& a = corner(place.triangle, 0);
  const Eigen::Vector3d ab = corner(place.triangle, 1) - a, ac = corner(place.triangle, 2) - a,
                        ap = place.position - a;
  const double d00 = ab.squaredNorm(), d01 = ab.dot(ac), d11 = ac.squaredNorm();
  const double d20 = ap.dot(ab), d21 = ap.dot(ac);
  const double inverse = 1 / (d00 * d11 - d01 * d01);
  const double v = std::clamp((d11 * d20 - d01 * d21) * inverse, 0.0, 1.0);
  const double w = std::clamp((d00 * d21 - d01 * d20) * inverse, 0.0, 1.0 - v);
  return {.triangle = place.triangle, .barycentric = {1 - v - w, v, w}};
}

Walk SurfaceWalk::walk(const SurfacePlace& from, const Eigen::Vector3d& plane_normal,
                       const Eigen::Vector3d& direction, double length) const noexcept {
  Walk result{.at = from};
  if (!(length > 0)) return result;
  Eigen::Vector3d here = from.position;
  const Eigen::Vector3d centroid =
      (corner(from.triangle, 0) + corner(from.triangle, 1) + corner(from.triangle, 2)) / 3;
  const double offset = plane_normal.dot(here + kTowardsCentroid * (centroid - here));
  int triangle = from.triangle;
  const auto side_of = [&](int vertex) {
    return plane_normal.dot(vertices_[static_cast<std::size_t>(vertex)]) - offset;
  };
  // Of the edge through which the walk came: the corner at which it begins in this triangle (3:
  // none yet), and the sides of its ends.
  std::size_t entry = 3;
  double entry_begin = 0, entry_end = 0;
  double left = length;
  for (int i = 0; i < kMaxTriangles; ++i) {
    const Triangle& t = triangles_[static_cast<std::size_t>(triangle)];
    std::array<double, 3> side;
    std::size_t exit = 3;
    Eigen::Vector3d end = here;
    const auto cross = [&](std::size_t k) {
      const std::size_t next = next_corner(k);
      const Eigen::Vector3d& a = vertices_[static_cast<std::size_t>(t.corners[k])];
      const Eigen::Vector3d& b = vertices_[static_cast<std::size_t>(t.corners[next])];
      return Eigen::Vector3d(a + side[k] / (side[k] - side[next]) * (b - a));
    };
    if (entry < 3) {
      // The plane cuts one of the other two edges.
      const std::size_t second = next_corner(entry), third = next_corner(second);
      side[entry] = entry_begin;
      side[second] = entry_end;
      side[third] = side_of(t.corners[third]);
      exit = (side[third] >= 0) == (entry_begin >= 0) ? second : third;
      end = cross(exit);
    } else {
      for (std::size_t k = 0; k < 3; ++k) side[k] = side_of(t.corners[k]);
      double farthest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        if ((side[k] >= 0) == (side[next_corner(k)] >= 0)) continue;
        const Eigen::Vector3d crossing = cross(k);
        const double forward = (crossing - here).dot(direction);
        if (exit < 3 && !(forward > farthest)) continue;
        exit = k;
        end = crossing;
        farthest = forward;
      }
    }
    if (exit == 3) break;  // only if the plane is not finite
    const double distance = (end - here).norm();
    if (distance >= left) {
      here += left / distance * (end - here);
      left = 0;
      break;
    }
    left -= distance;
    here = end;
    const int beyond = t.neighbours[exit];
    if (beyond < 0) {
      result.border_edge = static_cast<int>(exit);
      break;
    }
    entry_begin = side[next_corner(exit)];
    entry_end = side[exit];
    const Triangle& u = triangles_[static_cast<std::size_t>(beyond)];
    const int begin = t.corners[next_corner(exit)];
    entry = 0;
    while (entry < 2 && u.corners[entry] != begin) ++entry;
    triangle = beyond;
  }
  result.at = {triangle, here};
  result.length = length - left;
  return result;
}

bool SurfaceWalk::is_on_edge(int triangle, int k, const Eigen::Vector3d& place,
                             double tolerance) const noexcept {
  const Eigen::Vector3d& a = corner(triangle, k);
  const Eigen::Vector3d ab = corner(triangle, k == 2 ? 0 : k + 1) - a, ap = place - a;
  const double along = std::clamp(ap.dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (ap - along * ab).squaredNorm() <= tolerance * tolerance;
}

TouchedTriangles SurfaceWalk::touched(const SurfacePlace& place, double tolerance) const noexcept {
  TouchedTriangles found;
  found.triangles[0] = place.triangle;
  found.count = 1;
  for (int i = 0; i < found.count; ++i) {
    const int t = found.triangles[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      if (!is_on_edge(t, k, place.position, tolerance)) continue;
      const int next = neighbour(t, k);
      found.on_border = found.on_border || next < 0;
      if (next < 0 || found.count == TouchedTriangles::kMaxCount) continue;
      const auto end = found.triangles.begin() + found.count;
      if (std::find(found.triangles.begin(), end, next) != end) continue;
      found.triangles[static_cast<std::size_t>(found.count++)] = next;
    }
  }
  return found;
}

double SurfaceWalk::angle(int triangle, const Eigen::Vector3d& place,
                          double tolerance) const noexcept {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    if (is_on_edge(triangle, k, place, tolerance)) continue;
    const Eigen::Vector3d a = corner(triangle, k) - place,
                          b = corner(triangle, k == 2 ? 0 : k + 1) - place;
    sum += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return sum;
}

}  // namespace palpate::haptics
