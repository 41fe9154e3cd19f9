// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/image_part.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace palpate::sensing {
namespace {

/// Lit pixels are counted in squares of kCell pixels. Two by two of them are a block, which is lit
/// if kLeastLitPixels pixels of it are; windows of two periods need more on one column.
constexpr long kCell = kPartSpacing / 2;
constexpr int kLeastLitPixels = 8;

/// The whole image is taken if a part would have more than this share of it.
constexpr double kLargestShare = 0.9;

/// The cells in which blocks are lit, along one direction.
struct Range {
  long first = std::numeric_limits<long>::max();
  long last = -1;
  void add(long cell) {
    first = std::min(first, cell);
    last = std::max(last, cell);
  }
  /// First pixel and number of pixels of the cells and `margin` around them, in `size` pixels.
  [[nodiscard]] std::pair<long, long> pixels(long margin, long size) const {
    const long begin = std::max(0L, first * kCell - margin) / kPartSpacing * kPartSpacing;
    return {begin, std::min(size, (last + 1) * kCell + margin) - begin};
  }
};

Eigen::ArrayXXi lit_in_cells(const Mask& lit) {
  // One more in each direction, so that blocks reach over the last pixel.
  Eigen::ArrayXXi count = Eigen::ArrayXXi::Zero(lit.rows() / kCell + 2, lit.cols() / kCell + 2);
  Eigen::Array<std::uint8_t, 1, Eigen::Dynamic> in_columns(lit.cols());
  for (long row = 0; row < lit.rows(); row += kCell) {
    in_columns.setZero();
    for (long i = row; i < std::min(row + kCell, lit.rows()); ++i) in_columns += lit.row(i);
    for (long column = 0; column < lit.cols(); ++column)
      count(row / kCell, column / kCell) += in_columns[column];
  }
  return count;
}

}  // namespace

ImagePart lit_part(const Mask& lit, long margin) {
  const Eigen::ArrayXXi count = lit_in_cells(lit);
  Range down, across;
  for (long row = 0; row + 1 < count.rows(); ++row) {
    for (long column = 0; column + 1 < count.cols(); ++column) {
      const auto block = count.block<2, 2>(row, column);
      if (block.sum() < kLeastLitPixels) continue;
      for (const long i : {0, 1}) {
        if (block.row(i).any()) down.add(row + i);
        if (block.col(i).any()) across.add(column + i);
      }
    }
  }
  if (down.last < 0)
    return {0, 0, std::min(kPartSpacing, lit.rows()), std::min(kPartSpacing, lit.cols())};
  const auto [row, rows] = down.pixels(margin, lit.rows());
  const auto [column, columns] = across.pixels(margin, lit.cols());
  if (static_cast<double>(rows * columns) > kLargestShare * static_cast<double>(lit.size()))
    return {0, 0, lit.rows(), lit.cols()};
  return {row, column, rows, columns};
}

}  // namespace palpate::sensing
