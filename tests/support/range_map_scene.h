// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"

/// Range maps of meshes by ray casting, with the faults of real range maps and with their truth.
namespace palpate::geometry::test {

/// The camera that sees `bumpy` as a range map of `width` x 3/4 `width` pixels.
inline Camera bumpy_camera(int width) {
  const int height = width * 3 / 4;
  return {.width = width,
          .height = height,
          .fx = 1.2 * width,
          .fy = 1.2 * width,
          .cx = (width - 1) / 2.0,
          .cy = (height - 1) / 2.0};
}

/// Positions of the dents below, and their width (standard deviation of a Gaussian).
inline const Eigen::Vector3d kDent{-60.3, -41.1, 700};
constexpr double kDentWidth = 45;

/// A dent, away from the camera, in a soft block: points above the middle plane z = 700 move along
/// z and are sheared.
inline Eigen::Vector3d dented_block(const Eigen::Vector3d& rest, double depth = 20) {
  const double r2 = (rest - kDent).head<2>().squaredNorm();
  return rest + Eigen::Vector3d(0, 0, depth * std::exp(-r2 / (2 * kDentWidth * kDentWidth)));
}

/// Rolls the half x > 20 mm of a sheet at z = 700 about an axis along y, without stretching it.
inline Eigen::Vector3d bent(const Eigen::Vector3d& rest, double radius = 2000) {
  constexpr double kFirst = 20;
  if (rest.x() <= kFirst) return rest;
  const double angle = (rest.x() - kFirst) / radius;
  const double height = radius - (rest.z() - 700);
  return {kFirst + height * std::sin(angle), rest.y(), 700 + radius - height * std::cos(angle)};
}

template <typename Map>
TriangleMesh deformed(TriangleMesh mesh, const Map& map) {
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    mesh.vertices.col(v) = map(Eigen::Vector3d(mesh.vertices.col(v)));
  }
  return mesh;
}

/// Depth of the first surface on each pixel's ray; rays end at `far` mm.
inline RangeMap render(const TriangleMesh& mesh, const Camera& camera, double far = 5000) {
  const SurfaceQuery query(mesh);
  const Eigen::Matrix2Xd rays = pixel_rays(camera);
  RangeMap map{
      ImageF::Constant(camera.height, camera.width, std::numeric_limits<float>::quiet_NaN()),
      camera};
  parallel_for(camera.height, [&](int row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector3d ray = rays.col(row * camera.width + col).homogeneous();
      const auto hit = query.first_hit(Eigen::Vector3d::Zero(), far * ray);
      if (hit) map.z(row, col) = static_cast<float>(hit->position.z());
    }
  });
  return map;
}

/// Adds normal noise of standard deviation `sigma` mm to each depth.
inline void add_noise(RangeMap& map, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (float& z : map.z.reshaped<Eigen::RowMajor>()) z += static_cast<float>(normal(random));
}

/// Makes round holes, up to 1/20 of the image width across, until `fraction` of the known depths
/// are lost.
inline void punch_holes(RangeMap& map, double fraction, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto known = [&] { return static_cast<double>((map.z > 0).count()); };
  const double rest = (1 - fraction) * known();
  while (known() > rest) {
    const double x = uniform(random) * static_cast<double>(map.z.cols());
    const double y = uniform(random) * static_cast<double>(map.z.rows());
    const double radius = uniform(random) * static_cast<double>(map.z.cols()) / 40;
    for (Eigen::Index row = 0; row < map.z.rows(); ++row) {
      for (Eigen::Index col = 0; col < map.z.cols(); ++col) {
        if (std::hypot(static_cast<double>(col) - x, static_cast<double>(row) - y) < radius) {
          map.z(row, col) = std::numeric_limits<float>::quiet_NaN();
        }
      }
    }
  }
}

/// A rod with a pointed tip, closed.
inline TriangleMesh rod(const Eigen::Vector3d& tip, const Eigen::Vector3d& end, double radius) {
  constexpr int kSides = 24;
  const Eigen::Vector3d along = (end - tip).normalized();
  const Eigen::Vector3d across = along.unitOrthogonal() * radius;
  const Eigen::Vector3d other = along.cross(across);
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 * kSides + 2);
  mesh.triangles.resize(3, 4 * kSides);
  mesh.vertices.col(2 * kSides) = tip;
  mesh.vertices.col(2 * kSides + 1) = end;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    const Eigen::Vector3d out = std::cos(angle) * across + std::sin(angle) * other;
    mesh.vertices.col(i) = tip + radius * along + out;
    mesh.vertices.col(kSides + i) = end + out;
    const int next = (i + 1) % kSides;
    mesh.triangles.col(4 * i) << 2 * kSides, next, i;
    mesh.triangles.col(4 * i + 1) << i, next, kSides + i;
    mesh.triangles.col(4 * i + 2) << next, kSides + next, kSides + i;
    mesh.triangles.col(4 * i + 3) << 2 * kSides + 1, kSides + i, kSides + next;
  }
  return mesh;
}

inline TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both;
  both.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  both.vertices << a.vertices, b.vertices;
  both.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  both.triangles << a.triangles,
      (b.triangles.array() + static_cast<int>(a.vertices.cols())).matrix();
  return both;
}

/// Marks the `points` that the camera measures in the scene: nothing occludes them, and the depth
/// of their pixel is known.
inline std::vector<bool> visible(const Eigen::Matrix3Xd& points, const TriangleMesh& scene,
                                 const RangeMap& map) {
  const SurfaceQuery query(scene);
  std::vector<bool> is_visible(static_cast<std::size_t>(points.cols()), false);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d point = points.col(i);
    const Eigen::Vector2d image = distort(map.camera, point.hnormalized());
    const auto col = std::lround(image.x());
    const auto row = std::lround(image.y());
    if (row < 0 || row >= map.z.rows() || col < 0 || col >= map.z.cols()) continue;
    if (!(map.z(row, col) > 0)) continue;
    constexpr double kBefore = 1 - 1e-6;  // of the way to the point
    is_visible[static_cast<std::size_t>(i)] =
        !query.first_hit(Eigen::Vector3d::Zero(), kBefore * point);
  }
  return is_visible;
}

}  // namespace palpate::geometry::test
