// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"

/// Helpers that tests of contact triangulations share.
namespace palpate::geometry::test {

/// Weights: some tens of operations on values of the order of one, after a chain of flips.
inline constexpr double kWeightRounding = 1e-9;

inline std::array<int, 3> sorted_corners(const Eigen::Vector3i& triangle) {
  std::array<int, 3> corners = {triangle[0], triangle[1], triangle[2]};
  std::ranges::sort(corners);
  return corners;
}

inline std::vector<SurfacePoint> nearest_places(const TriangleMesh& surface,
                                                const std::vector<Eigen::Vector3d>& points) {
  const SurfaceQuery query(surface);
  std::vector<SurfacePoint> places;
  for (const Eigen::Vector3d& point : points) places.push_back(query.closest_point(point).at);
  return places;
}

/// Points of a grid, each moved at random by up to `jitter` of the spacing.
inline std::vector<Eigen::Vector3d> jittered_grid(int cols, int rows, double spacing,
                                                  double jitter) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> shift(-jitter * spacing, jitter * spacing);
  std::vector<Eigen::Vector3d> points;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      points.push_back({(c + 1) * spacing + shift(random), (r + 1) * spacing + shift(random), 0});
    }
  }
  return points;
}

struct Counts {
  int vertices = 0;
  int edges = 0;
  int faces = 0;
  [[nodiscard]] int euler() const { return vertices - edges + faces; }
};

/// Counts the elements in use, after checking that the mesh is an oriented manifold with border: no
/// triangle twice, no side of an edge twice, and the edges opposite to a vertex form one chain.
inline Counts check_manifold(const TriangleMesh& mesh) {
  std::set<std::pair<int, int>> sides;
  std::set<std::pair<int, int>> edges;
  std::set<std::array<int, 3>> faces;
  std::map<int, std::vector<std::pair<int, int>>> links;
  for (const Eigen::Vector3i t : mesh.triangles.colwise()) {
    EXPECT_TRUE(faces.insert(sorted_corners(t)).second) << "a triangle twice";
    for (int k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      EXPECT_TRUE(sides.emplace(a, b).second) << "edge " << a << " " << b;
      edges.insert(std::minmax(a, b));
      links[t[(k + 2) % 3]].emplace_back(a, b);
    }
  }
  for (auto& [vertex, link] : links) {
    std::set<int> reached = {link.front().first};
    for (size_t pass = 0; pass < link.size(); ++pass) {
      for (const auto& [a, b] : link) {
        if (reached.contains(a) || reached.contains(b)) reached.insert({a, b});
      }
    }
    for (const auto& [a, b] : link) EXPECT_TRUE(reached.contains(a)) << "two fans at " << vertex;
  }
  return {.vertices = static_cast<int>(links.size()),
          .edges = static_cast<int>(edges.size()),
          .faces = static_cast<int>(faces.size())};
}

struct Circle {
  Eigen::Vector2d centre;
  double radius;
};
inline Circle circumcircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                           const Eigen::Vector2d& c) {
  Eigen::Matrix2d sides;
  sides << (b - a).transpose(), (c - a).transpose();
  const Eigen::Vector2d centre =
      a +
      sides.fullPivLu().solve(Eigen::Vector2d((b - a).squaredNorm(), (c - a).squaredNorm()) / 2);
  return {.centre = centre, .radius = (centre - a).norm()};
}

inline double nearest_other(const Eigen::Matrix3Xd& places, const std::array<int, 3>& corners,
                            const Eigen::Vector2d& centre) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < places.cols(); ++i) {
    if (std::ranges::find(corners, i) != corners.end()) continue;
    nearest = std::min(nearest, (places.col(i).head<2>() - centre).norm());
  }
  return nearest;
}

/// Contacts in different triangles at random: in faces, on edges and at vertices in turn.
inline std::vector<SurfacePoint> random_contacts(const TriangleMesh& surface, int count,
                                                 unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, static_cast<int>(surface.triangles.cols()) - 1);
  std::uniform_real_distribution<double> part(0.05, 0.95);
  std::vector<SurfacePoint> contacts;
  std::set<int> vertices;  // of triangles in use: no two contacts share one
  while (static_cast<int>(contacts.size()) < count) {
    const int t = any(random);
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const bool is_free = std::ranges::none_of(corners, [&](int v) { return vertices.contains(v); });
    const bool is_crowded = 8 * count > surface.triangles.cols();
    if (!is_free && !is_crowded) continue;
    if (is_crowded && !vertices.insert(-1 - t).second) continue;
    vertices.insert(corners.begin(), corners.end());
    const double s = part(random);
    const double r = part(random);
    const size_t kind = is_crowded ? 0 : contacts.size() % 3;
    contacts.push_back({.triangle = t,
                        .barycentric = kind == 0   ? Eigen::Vector3d(1 - s, s * (1 - r), s * r)
                                       : kind == 1 ? Eigen::Vector3d(1 - s, 0, s)
                                                   : Eigen::Vector3d(0, 1, 0)});
  }
  return contacts;
}

/// V - E + F with a vertex for each fan of triangles.
inline int euler_characteristic_of_fans(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  const auto half_edges = static_cast<int>(mesh.triangles.size());
  std::vector<bool> visited(static_cast<size_t>(half_edges), false);
  int fans = 0;
  int edges = 0;
  const auto next_out = [&](int h) {  // counter-clockwise
    const int last = 3 * (h / 3) + (h + 2) % 3;
    return opposite(last % 3, last / 3);
  };
  const auto is_first = [&](int h) { return opposite(h % 3, h / 3) < 0; };
  const auto walk = [&](int h) {
    ++fans;
    for (; h >= 0 && !visited[static_cast<size_t>(h)]; h = next_out(h)) {
      visited[static_cast<size_t>(h)] = true;
    }
  };
  for (int h = 0; h < half_edges; ++h) {
    if (opposite(h % 3, h / 3) < h) ++edges;
    if (is_first(h)) walk(h);
  }
  for (int h = 0; h < half_edges; ++h) {
    if (!visited[static_cast<size_t>(h)]) walk(h);
  }
  return fans - edges + static_cast<int>(mesh.triangles.cols());
}

}  // namespace palpate::geometry::test
