// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "scans/grid_blocks.h"
#include "scans/scan_distance.h"

namespace palpate::geometry {

/// The distance of a grid point from scans.
struct GridDistance {
  std::int64_t key = 0;
  double distance = 0;   ///< [mm] weighted mean of the signed distances, > 0 outside
  double weight = 0;     ///< sum of the weights of the scans, > 0
  double beyond = 0;     ///< [mm] least distance of the point beyond the borders of scans
  double precision = 0;  ///< [mm^-2] sum of 1 / sigma^2 of the scans
};

/// The distances of the points of a grid from scans, in the blocks near these. In single precision,
/// because the data are large: the distances are at most a few spacings.
class DistanceVolume {
 public:
  /// The values at the grid points of a block; the weight is 0 where they are unknown.
  struct Block {
    std::array<float, kBlockPoints> distance{}, weight{}, beyond{}, precision{};
  };

  /// The block with this key, which is added if it is not there. Valid until the next is added.
  Block& block(std::int64_t key);
  /// Combines the values with those of other scans: weighted means.
  void add(const DistanceVolume& other);
  /// \return none if no scan has a distance for this grid point.
  [[nodiscard]] std::optional<GridDistance> find(std::int64_t x, std::int64_t y,
                                                 std::int64_t z) const;
  [[nodiscard]] bool has_block(std::int64_t key) const { return numbers_.find(key) >= 0; }
  /// Holds all blocks; in units of the grid.
  [[nodiscard]] Eigen::AlignedBox3d box() const;
  [[nodiscard]] std::size_t bytes() const { return blocks_.size() * sizeof(Block); }

  /// Grid points at least one of whose 26 neighbours is on the other side of the surface; sorted by
  /// key.
  [[nodiscard]] std::vector<GridDistance> near_surface() const;

 private:
  [[nodiscard]] GridDistance point(std::size_t block, std::size_t place) const;
  [[nodiscard]] std::array<bool, kBlockPoints> beside_other_side(std::size_t block) const;

  BlockNumbers numbers_;
  std::deque<Block> blocks_;
};

/// The signed distances of a scan at the grid points within `reach` [mm] of it, as far as they are
/// known (see `ScanDistance`).
///
/// The weight of a distance d is that of the scan there, times (1 + (d / spacing)^2)^-2: the scan
/// that is nearest to a place decides there, so that the far side of a thin wall does not erase
/// the near one.
[[nodiscard]] DistanceVolume distances_around(const ScanDistance& scan, const Grid& grid,
                                              double reach);

}  // namespace palpate::geometry
