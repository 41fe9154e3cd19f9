// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "scans/scan_distance.h"

namespace palpate::geometry {

/// A cubic grid: point (i, j, k) is at origin + spacing (i, j, k), all indices in
/// [0, kGridPoints).
struct Grid {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [mm]
  double spacing = 0;                                ///< [mm]
};

/// Largest number of grid points along an axis: three indices fit into a key.
inline constexpr std::int64_t kGridPoints = std::int64_t{1} << 21;

/// Keys are ordered by z, then y, then x; (dx, dy, dz) further is `grid_step(dx, dy, dz)` more.
[[nodiscard]] constexpr std::int64_t grid_step(std::int64_t x, std::int64_t y, std::int64_t z) {
  return (z * kGridPoints + y) * kGridPoints + x;
}

/// [mm] position of the grid point of a key.
[[nodiscard]] Eigen::Vector3d grid_position(const Grid& grid, std::int64_t key);

/// What scans tell about a grid point.
struct GridDistance {
  std::int64_t key = 0;
  double distance = 0;   ///< [mm] weighted mean of the signed distances, > 0 outside
  double weight = 0;     ///< sum of the weights of the scans, > 0
  double beyond = 0;     ///< [mm] how far it is at least beyond the borders of scans
  double precision = 0;  ///< [mm^-2] sum of 1 / sigma^2 of the scans
};

/// The signed distances of a scan at the grid points within `reach` [mm] of it, by key. Only where
/// they are known (see `ScanDistance`).
///
/// The weight of a distance d is that of the scan there, times (1 + (d / spacing)^2)^-2: the scan
/// that is nearest to a place decides there, so that the far side of a thin wall does not erase
/// the near one.
/// \param check called after every quarter of a million places or less; may throw.
[[nodiscard]] std::vector<GridDistance> distances_around(const ScanDistance& scan, const Grid& grid,
                                                         double reach,
                                                         const std::function<void()>& check = {});

/// Combines what different scans tell: weighted means. Both sorted by key, as is the result.
[[nodiscard]] std::vector<GridDistance> combine(const std::vector<GridDistance>& a,
                                                const std::vector<GridDistance>& b);

}  // namespace palpate::geometry
