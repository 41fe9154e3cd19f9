// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/distance_volume.h"

#include <algorithm>
#include <cmath>

#include "scans/nearest_triangles.h"

namespace palpate::geometry {
namespace {

/// The sides of the grid points of a block and of those around it. Bit 0: inside, bit 1: outside.
constexpr std::size_t kPadded = kBlockEdge + 2;
using PaddedSides = std::array<std::uint8_t, kPadded * kPadded * kPadded>;

/// Each point also takes the sides of its neighbours at distance `step`.
void spread_sides(PaddedSides& sides, std::size_t step) {
  const PaddedSides before = sides;
  for (std::size_t i = step; i + step < sides.size(); ++i)
    sides[i] = static_cast<std::uint8_t>(before[i - step] | before[i] | before[i + step]);
}

}  // namespace

DistanceVolume::Block& DistanceVolume::block(std::int64_t key) {
  const auto number = static_cast<std::size_t>(numbers_.add(key));
  if (number == blocks_.size()) blocks_.emplace_back();
  return blocks_[number];
}

void DistanceVolume::add(const DistanceVolume& other) {
  for (std::size_t b = 0; b < other.blocks_.size(); ++b) {
    const auto number = static_cast<std::size_t>(numbers_.add(other.numbers_.keys()[b]));
    const Block& with = other.blocks_[b];
    if (number == blocks_.size()) {
      blocks_.push_back(with);
      continue;
    }
    Block& block = blocks_[number];
    for (std::size_t i = 0; i < kBlockPoints; ++i) {
      if (with.weight[i] == 0) continue;
      const float weight = block.weight[i] + with.weight[i];
      block.beyond[i] =
          block.weight[i] == 0 ? with.beyond[i] : std::min(block.beyond[i], with.beyond[i]);
      block.distance[i] =
          (block.weight[i] * block.distance[i] + with.weight[i] * with.distance[i]) / weight;
      block.weight[i] = weight;
      block.precision[i] += with.precision[i];
    }
  }
}

GridDistance DistanceVolume::point(std::size_t block, std::size_t place) const {
  const Block& at = blocks_[block];
  return {.key = key_in_block(numbers_.keys()[block], place),
          .distance = static_cast<double>(at.distance[place]),
          .weight = static_cast<double>(at.weight[place]),
          .beyond = static_cast<double>(at.beyond[place]),
          .precision = static_cast<double>(at.precision[place])};
}

std::optional<GridDistance> DistanceVolume::find(std::int64_t x, std::int64_t y,
                                                 std::int64_t z) const {
  const int block = numbers_.find(block_key(x, y, z));
  if (block < 0) return std::nullopt;
  const GridDistance there = point(static_cast<std::size_t>(block), place_in_block(x, y, z));
  if (there.weight == 0) return std::nullopt;
  return there;
}

Eigen::AlignedBox3d DistanceVolume::box() const {
  Eigen::AlignedBox3d box;
  for (const std::int64_t key : numbers_.keys()) {
    const Eigen::Array3d corner = grid_index(key);
    box.extend(corner.matrix());
    box.extend((corner + (kBlockEdge - 1)).matrix());
  }
  return box;
}

std::array<bool, kBlockPoints> DistanceVolume::beside_other_side(std::size_t block) const {
  PaddedSides sides{};
  const auto corner = grid_index(numbers_.keys()[block]).cast<std::int64_t>().eval();
  // The 27 blocks around, and the range of their points that are within one of this block.
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const int number = numbers_.find(numbers_.keys()[block] + kBlockEdge * grid_step(x, y, z));
        if (number < 0) continue;
        const Block& from = blocks_[static_cast<std::size_t>(number)];
        const auto range = [](int side) {
          return side < 0 ? std::array{-1, 0} : side > 0 ? std::array{8, 9} : std::array{0, 8};
        };
        for (int k = range(z)[0]; k < range(z)[1]; ++k) {
          for (int j = range(y)[0]; j < range(y)[1]; ++j) {
            for (int i = range(x)[0]; i < range(x)[1]; ++i) {
              const std::size_t place = place_in_block(corner[0] + i, corner[1] + j, corner[2] + k);
              if (from.weight[place] == 0) continue;
              const auto to =
                  (static_cast<std::size_t>(k + 1) * kPadded + static_cast<std::size_t>(j + 1)) *
                      kPadded +
                  static_cast<std::size_t>(i + 1);
              sides[to] = from.distance[place] < 0 ? 1 : 2;
            }
          }
        }
      }
    }
  }
  spread_sides(sides, 1);
  spread_sides(sides, kPadded);
  spread_sides(sides, kPadded * kPadded);
  std::array<bool, kBlockPoints> beside{};
  for (std::size_t i = 0; i < kBlockPoints; ++i) {
    const std::size_t x = i % kBlockEdge, y = i / kBlockEdge % kBlockEdge,
                      z = i / kBlockEdge / kBlockEdge;
    beside[i] =
        blocks_[block].weight[i] > 0 && sides[((z + 1) * kPadded + y + 1) * kPadded + x + 1] == 3;
  }
  return beside;
}

std::vector<GridDistance> DistanceVolume::near_surface() const {
  std::vector<GridDistance> points;
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    const std::array<bool, kBlockPoints> beside = beside_other_side(block);
    for (std::size_t i = 0; i < kBlockPoints; ++i) {
      if (beside[i]) points.push_back(point(block, i));
    }
  }
  std::ranges::sort(points, {}, &GridDistance::key);
  return points;
}

DistanceVolume distances_around(const ScanDistance& scan, const Grid& grid, double reach) {
  DistanceVolume volume;
  const std::deque<NearTriangles> found =
      nearest_triangles(scan.mesh(), scan.opposite(), grid, reach / grid.spacing);
  for (const NearTriangles& near : found) {
    DistanceVolume::Block& block = volume.block(near.block);
    for (std::size_t i = 0; i < kBlockPoints; ++i) {
      if (near.nearest[i].triangle < 0) continue;
      const PlaceDistance there =
          scan.at(grid_position(grid, key_in_block(near.block, i)), near.nearest[i]);
      if (there.weight == 0 || std::abs(there.distance) > reach) continue;
      const double d = there.distance / grid.spacing;
      block.distance[i] = static_cast<float>(there.distance);
      block.weight[i] = static_cast<float>(there.weight / ((1 + d * d) * (1 + d * d)));
      block.beyond[i] = static_cast<float>(there.beyond);
      block.precision[i] = static_cast<float>(there.precision);
    }
  }
  return volume;
}

}  // namespace palpate::geometry
