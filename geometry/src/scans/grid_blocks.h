// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

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

/// (i, j, k) of a key.
[[nodiscard]] inline Eigen::Array3d grid_index(std::int64_t key) {
  constexpr std::int64_t kMask = kGridPoints - 1;
  return {static_cast<double>(key & kMask), static_cast<double>(key / kGridPoints & kMask),
          static_cast<double>(key / kGridPoints / kGridPoints)};
}

/// [mm] position of the grid point of a key.
[[nodiscard]] inline Eigen::Vector3d grid_position(const Grid& grid, std::int64_t key) {
  return grid.origin.array() + grid.spacing * grid_index(key);
}

/// A block has 8 x 8 x 8 grid points, in the order of their keys. Its key is that of the first.
inline constexpr int kBlockBits = 3, kBlockEdge = 1 << kBlockBits;
inline constexpr std::size_t kBlockPoints = std::size_t{1} << 3 * kBlockBits;

/// Place of a grid point in its block.
[[nodiscard]] constexpr std::size_t place_in_block(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kInside = kBlockEdge - 1;
  return static_cast<std::size_t>(((z & kInside) << kBlockBits | (y & kInside)) << kBlockBits |
                                  (x & kInside));
}

/// Key of the block that has a grid point.
[[nodiscard]] constexpr std::int64_t block_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kFirst = ~std::int64_t{kBlockEdge - 1};
  return grid_step(x & kFirst, y & kFirst, z & kFirst);
}

/// Key of a grid point of a block.
[[nodiscard]] constexpr std::int64_t key_in_block(std::int64_t block, std::size_t place) {
  const auto at = static_cast<std::int64_t>(place);
  constexpr std::int64_t kInside = kBlockEdge - 1;
  return block + grid_step(at & kInside, at >> kBlockBits & kInside, at >> 2 * kBlockBits);
}

/// Numbers the blocks that are used: 0, 1, ... in the order in which they were added.
class BlockNumbers {
 public:
  /// \return -1 if the block is not there.
  [[nodiscard]] int find(std::int64_t block) const {
    const auto found = numbers_.find(block);
    return found == numbers_.end() ? -1 : found->second;
  }
  int add(std::int64_t block) {
    const auto [at, added] = numbers_.try_emplace(block, static_cast<int>(keys_.size()));
    if (added) keys_.push_back(block);
    return at->second;
  }
  [[nodiscard]] const std::vector<std::int64_t>& keys() const { return keys_; }

 private:
  std::unordered_map<std::int64_t, int> numbers_;
  std::vector<std::int64_t> keys_;
};

}  // namespace palpate::geometry
