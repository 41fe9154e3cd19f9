// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/distance_volume.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "palpate/geometry/mesh_measures.h"

namespace palpate::geometry {
namespace {

/// Places that are evaluated together, which bounds the memory of their results.
constexpr Eigen::Index kBatch = 1 << 18;

/// A cube of grid points, 2^level along each edge; `corner` is the key of the first.
using Cubes = std::vector<std::int64_t>;

constexpr std::int64_t kIndexMask = kGridPoints - 1;

Eigen::Matrix3Xd centres(const Grid& grid, const Cubes& cubes, std::size_t first,
                         Eigen::Index count, int level) {
  const double half = (std::ldexp(1.0, level) - 1) / 2 * grid.spacing;
  Eigen::Matrix3Xd places(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    places.col(i) = grid_position(grid, cubes[first + static_cast<std::size_t>(i)]).array() + half;
  }
  return places;
}

/// Calls `visit(first, places)` for batches of the cubes' centres, and `check` after each.
void for_each_batch(const Grid& grid, const Cubes& cubes, int level,
                    const std::function<void()>& check, auto&& visit) {
  for (std::size_t first = 0; first < cubes.size(); first += kBatch) {
    const auto count =
        std::min<Eigen::Index>(kBatch, static_cast<Eigen::Index>(cubes.size() - first));
    visit(first, centres(grid, cubes, first, count, level));
    if (check) check();
  }
}

/// The eighths of the cubes that may have a grid point within reach.
Cubes divide(const ScanDistance& scan, const Grid& grid, const Cubes& cubes, int level,
             double reach, const std::function<void()>& check) {
  const double to_corner = std::numbers::sqrt3 * (std::ldexp(1.0, level) - 1) / 2 * grid.spacing;
  const std::int64_t half = std::int64_t{1} << (level - 1);
  Cubes eighths;
  for_each_batch(grid, cubes, level, check, [&](std::size_t first, const Eigen::Matrix3Xd& places) {
    const Eigen::VectorXd distances = scan.unsigned_at(places);
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      if (distances[i] > reach + to_corner) continue;
      for (int octant = 0; octant < 8; ++octant) {
        eighths.push_back(cubes[first + static_cast<std::size_t>(i)] +
                          half * grid_step(octant & 1, octant >> 1 & 1, octant >> 2));
      }
    }
  });
  return eighths;
}

}  // namespace

Eigen::Vector3d grid_position(const Grid& grid, std::int64_t key) {
  const Eigen::Array3d index(static_cast<double>(key & kIndexMask),
                             static_cast<double>(key / kGridPoints & kIndexMask),
                             static_cast<double>(key / kGridPoints / kGridPoints));
  return grid.origin.array() + grid.spacing * index;
}

std::vector<GridDistance> distances_around(const ScanDistance& scan, const Grid& grid, double reach,
                                           const std::function<void()>& check) {
  const Eigen::Vector3d far = bounding_box(scan.mesh()).max().array() + reach;
  const double extent = (far - grid.origin).maxCoeff() / grid.spacing + 1;
  const int root = std::max(0, static_cast<int>(std::ceil(std::log2(extent))));
  Cubes cubes = {0};
  for (int level = root; level > 0; --level) cubes = divide(scan, grid, cubes, level, reach, check);
  // Order the grid points before they are evaluated, and the result is ordered.
  std::sort(cubes.begin(), cubes.end());
  std::vector<GridDistance> known;
  for_each_batch(grid, cubes, 0, check, [&](std::size_t first, const Eigen::Matrix3Xd& places) {
    const PlaceDistances there = scan.at(places);
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      const double d = there.distance[i] / grid.spacing;
      if (std::abs(there.distance[i]) > reach || there.weight[i] == 0) continue;
      known.push_back({.key = cubes[first + static_cast<std::size_t>(i)],
                       .distance = there.distance[i],
                       .weight = there.weight[i] / ((1 + d * d) * (1 + d * d)),
                       .beyond = there.beyond[i],
                       .precision = there.precision[i]});
    }
  });
  return known;
}

std::vector<GridDistance> combine(const std::vector<GridDistance>& a,
                                  const std::vector<GridDistance>& b) {
  std::vector<GridDistance> both;
  both.reserve(std::max(a.size(), b.size()));
  auto at_a = a.begin();
  auto at_b = b.begin();
  while (at_a != a.end() || at_b != b.end()) {
    if (at_b == b.end() || (at_a != a.end() && at_a->key < at_b->key)) {
      both.push_back(*at_a++);
    } else if (at_a == a.end() || at_b->key < at_a->key) {
      both.push_back(*at_b++);
    } else {
      const double weight = at_a->weight + at_b->weight;
      both.push_back(
          {.key = at_a->key,
           .distance = (at_a->weight * at_a->distance + at_b->weight * at_b->distance) / weight,
           .weight = weight,
           .beyond = std::min(at_a->beyond, at_b->beyond),
           .precision = at_a->precision + at_b->precision});
      ++at_a;
      ++at_b;
    }
  }
  return both;
}

}  // namespace palpate::geometry
