// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

/// Surfaces whose geometry is known in closed form.
namespace palpate::geometry::test {

/// A height field z(x, y) over cols x rows squares of size `spacing` from the origin, diagonals
/// alternating.
inline TriangleMesh height_field(int cols, int rows, double spacing,
                                 const std::function<double(double, double)>& height) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, (cols + 1) * (rows + 1));
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= cols; ++c) {
      const double x = c * spacing;
      const double y = r * spacing;
      mesh.vertices.col(r * (cols + 1) + c) << x, y, height(x, y);
    }
  }
  mesh.triangles.resize(3, 2 * cols * rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const int a = r * (cols + 1) + c;
      const int b = a + 1;
      const int d = a + cols + 1;
      const int e = d + 1;
      const int t = 2 * (r * cols + c);
      if ((r + c) % 2 == 0) {
        mesh.triangles.col(t) << a, b, e;
        mesh.triangles.col(t + 1) << a, e, d;
      } else {
        mesh.triangles.col(t) << a, b, d;
        mesh.triangles.col(t + 1) << b, e, d;
      }
    }
  }
  return mesh;
}

inline TriangleMesh flat_sheet(int cols, int rows, double spacing) {
  return height_field(cols, rows, spacing, [](double, double) { return 0.0; });
}

/// An icosahedron on a sphere about the origin, with each triangle split into four `levels` times.
inline TriangleMesh icosphere(int levels, double radius) {
  const double g = std::numbers::phi;
  std::vector<Eigen::Vector3d> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                         {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                         {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Eigen::Vector3i> triangles = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle_of;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] = middle_of.try_emplace(std::minmax(a, b), 0);
      if (is_new) {
        place->second = static_cast<int>(points.size());
        points.push_back(points[static_cast<size_t>(a)].normalized() +
                         points[static_cast<size_t>(b)].normalized());
      }
      return place->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& t : triangles) {
      const int ab = middle(t[0], t[1]);
      const int bc = middle(t[1], t[2]);
      const int ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) {
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = radius * points[i].normalized();
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (size_t i = 0; i < triangles.size(); ++i) {
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  }
  return mesh;
}

/// A closed star of 320 triangles whose radii range from 1e-6 to 1e6 mm, at random.
inline TriangleMesh star_of_many_scales() {
  TriangleMesh star = icosphere(2, 1);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-6, 6);
  for (Eigen::Index v = 0; v < star.vertices.cols(); ++v)
    star.vertices.col(v) *= std::pow(10, exponent(random));
  return star;
}

/// Random triangles in a cube of half-width `size`; they intersect, and some are needles.
inline TriangleMesh random_triangles(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3 * count);
  mesh.triangles.resize(3, count);
  for (int t = 0; t < count; ++t) {
    const Eigen::Vector3d centre{uniform(random), uniform(random), uniform(random)};
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner{uniform(random), uniform(random), uniform(random)};
      mesh.vertices.col(3 * t + k) = centre + 0.2 * corner;
    }
    mesh.triangles.col(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  }
  return mesh;
}

/// The mesh after a rigid motion.
inline TriangleMesh moved(TriangleMesh mesh, const Eigen::Isometry3d& T) {
  mesh.vertices = T * mesh.vertices;
  return mesh;
}

/// The mesh in another unit of length.
inline TriangleMesh scaled(TriangleMesh mesh, double factor) {
  mesh.vertices *= factor;
  return mesh;
}

}  // namespace palpate::geometry::test
