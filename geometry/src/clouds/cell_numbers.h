// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/numbers.h"
#include "palpate/core/error.h"

namespace palpate::geometry {

/// Position of a cell in a grid of cubes.
using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

/// Cells along an axis from the origin. Below it a point's cell is found within 2^-12 of its edge.
inline constexpr double kMostCells = 0x1p40;

/// The cell of a point, of the cubes of this edge [mm] that begin at `origin`.
/// \param what is too small if a cell is too far away: "edge".
/// \throws InvalidInput if it is more than kMostCells away from the origin.
[[nodiscard]] inline Cell cell_of(const Eigen::Vector3d& point, const Eigen::Vector3d& origin,
                                  double edge, const char* what) {
  const Eigen::Vector3d place = ((point - origin) / edge).array().floor();
  if (!(place.cwiseAbs().maxCoeff() <= kMostCells))
    throw InvalidInput(std::string(what) +
                       ": is smaller than 2^-40 of the distance of a point; take a larger one, or "
                       "remove far points first");
  return place.cast<std::int64_t>();
}

/// Numbers the occupied cells of a grid: 0, 1, ... in the order in which they are first asked for.
/// A hash table with linear probing.
class CellNumbers {
 public:
  /// The number of a cell, a new one if it has none.
  int number(const Cell& cell) {
    if (4 * cells_.size() >= 3 * slots_.size()) grow();
    int& slot = slots_[slot_of(cell)];
    if (slot == kNone) {
      slot = static_cast<int>(cells_.size());
      cells_.push_back(cell);
    }
    return slot;
  }
  /// kNone if it has no number.
  [[nodiscard]] int find(const Cell& cell) const { return slots_[slot_of(cell)]; }
  /// In the order of their numbers.
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }

 private:
  [[nodiscard]] std::size_t slot_of(const Cell& cell) const {
    // Odd factors spread each coordinate; the shift brings the upper bits, which mix best, down.
    std::uint64_t hash = static_cast<std::uint64_t>(cell[0]) * 0x9e3779b97f4a7c15U ^
                         static_cast<std::uint64_t>(cell[1]) * 0xc2b2ae3d27d4eb4fU ^
                         static_cast<std::uint64_t>(cell[2]) * 0x165667b19e3779f9U;
    hash = (hash ^ (hash >> 32U)) * 0xd6e8feb86659fd93U;
    std::size_t slot = (hash ^ (hash >> 32U)) & (slots_.size() - 1);
    while (slots_[slot] != kNone && cells_[static_cast<std::size_t>(slots_[slot])] != cell)
      slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), kNone);
    for (std::size_t i = 0; i < cells_.size(); ++i)
      slots_[slot_of(cells_[i])] = static_cast<int>(i);
  }

  std::vector<Cell> cells_;
  std::vector<int> slots_ = std::vector<int>(64, kNone);  ///< a power of two
};

}  // namespace palpate::geometry
