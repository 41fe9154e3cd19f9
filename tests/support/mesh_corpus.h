// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/triangle_mesh.h"

/// Meshes as users have them: range maps with noise and holes, gloves, thin closed shapes.
namespace palpate::geometry::test {

/// [mm] depth of `bumpy` at s in [0, 1] from left to right and t in [0, 0.75] downwards.
inline double bumpy_depth(double s, double t) {
  constexpr double pi = std::numbers::pi;
  const auto bell = [](double x, double y, double width) {
    return std::exp(-(x * x + y * y) / (2 * width * width));
  };
  return 700 - (60 * bell(s - 0.5, t - 0.375, 0.18) +
                12 * std::sin(6 * pi * s + 0.7) * std::cos(5 * pi * t) +
                4 * std::sin(22 * pi * s) * std::sin(18 * pi * t));
}

/// Returns true if (s, t) lies in one of the two holes of `bumpy`.
inline bool in_bumpy_hole(double s, double t) {
  return std::hypot(s - 0.25, t - 0.25) < 0.06 || std::hypot(s - 0.75, t - 0.5) < 0.04;
}

/// A range map of about `triangle_count` triangles: a bump, waves and ripples 640..720 mm in front
/// of a pinhole camera, with two circular holes, cells split along their shorter diagonal, and
/// uniform noise of +-`noise` mm on the depth.
inline TriangleMesh bumpy(int triangle_count, double noise = 0, unsigned seed = 1) {
  const int rows = static_cast<int>(std::lround(std::sqrt(0.375 * triangle_count))) + 1;
  const int cols = static_cast<int>(std::lround((rows - 1) / 0.75)) + 1;
  const double focal_length = 1.2 * cols;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-noise, noise);
  std::vector<Eigen::Vector3d> points(static_cast<size_t>(rows * cols));
  std::vector<bool> hole(points.size());
  for (int v = 0; v < rows; ++v) {
    for (int u = 0; u < cols; ++u) {
      const auto i = static_cast<size_t>(v * cols + u);
      const double s = static_cast<double>(u) / (cols - 1);
      const double t = 0.75 * v / (rows - 1);
      const double z = bumpy_depth(s, t) + (noise > 0 ? uniform(random) : 0);
      points[i] = {(u - (cols - 1) / 2.0) / focal_length * z,
                   (v - (rows - 1) / 2.0) / focal_length * z, z};
      hole[i] = in_bumpy_hole(s, t);
    }
  }
  std::vector<Eigen::Vector3i> triangles;
  const auto add = [&](int a, int b, int c) {
    const auto known = [&](int i) { return !hole[static_cast<size_t>(i)]; };
    if (known(a) && known(b) && known(c)) triangles.emplace_back(a, b, c);
  };
  for (int v = 0; v + 1 < rows; ++v) {
    for (int u = 0; u + 1 < cols; ++u) {
      const int a = v * cols + u;
      const int b = a + 1;
      const int c = a + cols;
      const int d = c + 1;
      const auto length = [&](int i, int j) {
        return (points[static_cast<size_t>(i)] - points[static_cast<size_t>(j)]).norm();
      };
      // Counter-clockwise seen from the camera, which looks along +z.
      if (length(a, d) <= length(b, c)) {
        add(a, c, d);
        add(a, d, b);
      } else {
        add(a, c, b);
        add(b, c, d);
      }
    }
  }
  // Leave out vertices that no triangle uses.
  std::vector<int> compact(points.size(), -1);
  TriangleMesh mesh;
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  std::vector<Eigen::Vector3d> used;
  for (size_t i = 0; i < triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      int& index = compact[static_cast<size_t>(triangles[i][k])];
      if (index < 0) {
        index = static_cast<int>(used.size());
        used.push_back(points[static_cast<size_t>(triangles[i][k])]);
      }
      mesh.triangles(k, static_cast<Eigen::Index>(i)) = index;
    }
  }
  mesh.vertices.resize(3, static_cast<Eigen::Index>(used.size()));
  for (size_t i = 0; i < used.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = used[i];
  return mesh;
}

/// The closed surface where `distance` is zero, extracted from a box by marching tetrahedra. Every
/// cube of the grid consists of six tetrahedra around one diagonal, so neighbours always agree and
/// the result is manifold; many triangles are needles. `distance` is negative inside.
inline TriangleMesh polygonise(const std::function<double(const Eigen::Vector3d&)>& distance,
                               const Eigen::AlignedBox3d& box, double spacing) {
  const Eigen::Array3i n =
      (box.sizes().array() / spacing).ceil().cast<int>() + 1;  // grid points per axis
  const auto grid_point = [&](int i) {
    const Eigen::Vector3i place(i % n.x(), i / n.x() % n.y(), i / (n.x() * n.y()));
    return Eigen::Vector3d(box.min() + spacing * place.cast<double>());
  };
  std::vector<double> value(static_cast<size_t>(n.prod()));
  for (size_t i = 0; i < value.size(); ++i) value[i] = distance(grid_point(static_cast<int>(i)));
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  std::map<std::pair<int, int>, int> on_edge;
  const auto crossing = [&](int a, int b) {
    const auto [place, is_new] = on_edge.try_emplace(std::minmax(a, b), 0);
    if (is_new) {
      place->second = static_cast<int>(vertices.size());
      const double at_a = value[static_cast<size_t>(a)];
      const double at_b = value[static_cast<size_t>(b)];
      vertices.emplace_back(grid_point(a) + at_a / (at_a - at_b) * (grid_point(b) - grid_point(a)));
    }
    return place->second;
  };
  const std::array<int, 3> step = {1, n.x(), n.x() * n.y()};
  const auto tetrahedron = [&](std::array<int, 4> corner) {
    std::sort(corner.begin(), corner.end(), [&](int a, int b) {
      return std::pair(value[static_cast<size_t>(a)] >= 0, a) <
             std::pair(value[static_cast<size_t>(b)] >= 0, b);
    });
    const auto inside = std::count_if(corner.begin(), corner.end(),
                                      [&](int i) { return value[static_cast<size_t>(i)] < 0; });
    const auto add = [&](int a, int b, int c) {
      const Eigen::Vector3d& p = vertices[static_cast<size_t>(a)];
      const Eigen::Vector3d normal =
          (vertices[static_cast<size_t>(b)] - p).cross(vertices[static_cast<size_t>(c)] - p);
      const bool outwards = normal.dot(p - grid_point(corner[0])) >= 0;
      triangles.emplace_back(a, outwards ? b : c, outwards ? c : b);
    };
    if (inside == 1) {
      add(crossing(corner[0], corner[1]), crossing(corner[0], corner[2]),
          crossing(corner[0], corner[3]));
    } else if (inside == 3) {
      add(crossing(corner[0], corner[3]), crossing(corner[1], corner[3]),
          crossing(corner[2], corner[3]));
    } else if (inside == 2) {
      const int a = crossing(corner[0], corner[2]);
      const int b = crossing(corner[0], corner[3]);
      const int c = crossing(corner[1], corner[3]);
      const int d = crossing(corner[1], corner[2]);
      add(a, b, c);
      add(a, c, d);
    }
  };
  for (int z = 0; z + 1 < n.z(); ++z) {
    for (int y = 0; y + 1 < n.y(); ++y) {
      for (int x = 0; x + 1 < n.x(); ++x) {
        std::array<int, 3> axes = {0, 1, 2};
        const int first = x + y * step[1] + z * step[2];
        do {
          const int second = first + step[static_cast<size_t>(axes[0])];
          const int third = second + step[static_cast<size_t>(axes[1])];
          tetrahedron({first, second, third, third + step[static_cast<size_t>(axes[2])]});
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (size_t i = 0; i < vertices.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices[i];
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (size_t i = 0; i < triangles.size(); ++i)
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  return mesh;
}

/// A closed glove, 150 mm high: a palm and five finger capsules, two of them close together.
inline TriangleMesh glove(double spacing = 3.1) {
  using Eigen::Vector3d;
  struct Capsule {
    Vector3d from, to;
    double radius;
  };
  const std::array<Capsule, 5> fingers = {{{{-32, 20, 0}, {-62, 52, 6}, 9.3},
                                           {{-27, 45, 0}, {-33, 112, 3}, 8.1},
                                           {{-9, 48, 0}, {-10, 122, 2}, 8.4},
                                           {{9, 48, 0}, {12, 115, 3}, 8.2},
                                           {{26, 43, 0}, {36, 96, 5}, 7.1}}};
  const auto distance = [&](const Vector3d& p) {
    // The palm is a box with a large rounding.
    const Vector3d outside = (p - Vector3d(0, 22, 0)).cwiseAbs() - Vector3d(27, 26, 2);
    double nearest = outside.cwiseMax(0).norm() + std::min(outside.maxCoeff(), 0.0) - 9.7;
    for (const Capsule& f : fingers) {
      const Vector3d along = f.to - f.from;
      const double h = std::clamp((p - f.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (p - f.from - h * along).norm() - f.radius);
    }
    return nearest;
  };
  return polygonise(distance, {Vector3d(-80.3, -20.7, -20.1), Vector3d(50, 140, 25)}, spacing);
}

/// A closed sheet: two wavy faces `thickness` apart, joined at their border.
inline TriangleMesh closed_sheet(int cols = 60, int rows = 40, double spacing = 2.0,
                                 double thickness = 1.0) {
  const int side = (cols + 1) * (rows + 1);
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 * side);
  std::vector<Eigen::Vector3i> triangles;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= cols; ++c) {
      const double x = c * spacing;
      const double y = r * spacing;
      const double z = 5 * std::sin(x / 17) * std::cos(y / 13);
      mesh.vertices.col(r * (cols + 1) + c) << x, y, z + thickness / 2;
      mesh.vertices.col(side + r * (cols + 1) + c) << x, y, z - thickness / 2;
      if (r == rows || c == cols) continue;
      const int a = r * (cols + 1) + c;
      const int d = a + cols + 1;
      triangles.insert(triangles.end(), {{a, a + 1, d + 1},
                                         {a, d + 1, d},
                                         {side + a, side + d + 1, side + a + 1},
                                         {side + a, side + d, side + d + 1}});
    }
  }
  const auto wall = [&](int a, int b) {  // the border runs from a to b, surface on its left
    triangles.insert(triangles.end(), {{b, a, side + a}, {b, side + a, side + b}});
  };
  for (int c = 0; c < cols; ++c) {
    wall(c, c + 1);
    wall(rows * (cols + 1) + c + 1, rows * (cols + 1) + c);
  }
  for (int r = 0; r < rows; ++r) {
    wall(r * (cols + 1) + cols, (r + 1) * (cols + 1) + cols);
    wall((r + 1) * (cols + 1), r * (cols + 1));
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (size_t i = 0; i < triangles.size(); ++i)
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  return mesh;
}

/// A torus about the z axis: genus one, and thin if the tube is small.
inline TriangleMesh torus(int around, int across, double radius, double tube_radius) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, around * across);
  mesh.triangles.resize(3, 2 * around * across);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around;
      const double v = 2 * std::numbers::pi * j / across;
      const double r = radius + tube_radius * std::cos(v);
      mesh.vertices.col(i * across + j) << r * std::cos(u), r * std::sin(u),
          tube_radius * std::sin(v);
      const int a = i * across + j;
      const int b = (i + 1) % around * across + j;
      const int c = (i + 1) % around * across + (j + 1) % across;
      const int d = i * across + (j + 1) % across;
      mesh.triangles.col(2 * a) << a, b, c;
      mesh.triangles.col(2 * a + 1) << a, c, d;
    }
  }
  return mesh;
}

inline long border_edges(const TriangleMesh& mesh) {
  return (opposite_half_edges(mesh).array() < 0).count();
}

}  // namespace palpate::geometry::test
