// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate::geometry {

/// Cells of a Morton curve (Z-order) along each axis; neighbours on it are near in space.
inline constexpr std::uint32_t kMortonCells = std::uint32_t{1} << 16;

/// An element with its place along the curve.
struct OnMortonCurve {
  std::uint64_t place;
  int index;
};

/// The place of a cell: the bits of its coordinates in turns, those of x last.
/// \param cell each below `kMortonCells`.
[[nodiscard]] std::uint64_t morton_place(const Eigen::Array<std::uint32_t, 3, 1>& cell);

/// Returns the elements sorted by place; those at the same place keep their order.
[[nodiscard]] std::vector<OnMortonCurve> sorted(std::vector<OnMortonCurve> all);

}  // namespace palpate::geometry
