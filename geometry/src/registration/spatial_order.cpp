// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/spatial_order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace palpate::geometry {
namespace {

constexpr double kCellsPerAxis = 1024;

/// Puts two zeros between the bits of a number below 1024.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16U) & 0x030000ffU;
  x = (x | x << 8U) & 0x0300f00fU;
  x = (x | x << 4U) & 0x030c30c3U;
  return (x | x << 2U) & 0x09249249U;
}

}  // namespace

Eigen::Matrix3Xd in_spatial_order(const Eigen::Matrix3Xd& points) {
  if (points.cols() == 0) return points;
  const Eigen::Vector3d lowest = points.rowwise().minCoeff();
  const double size = (points.rowwise().maxCoeff() - lowest).maxCoeff();
  if (!(size > 0) || !std::isfinite(size)) return points;
  std::vector<std::pair<std::uint32_t, Eigen::Index>> order;
  order.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Array3d place = (points.col(i) - lowest) / size * kCellsPerAxis;
    const auto cell = place.min(kCellsPerAxis - 1).cast<std::uint32_t>().eval();
    order.emplace_back(
        spread_bits(cell[0]) | spread_bits(cell[1]) << 1U | spread_bits(cell[2]) << 2U, i);
  }
  std::sort(order.begin(), order.end());
  Eigen::Matrix3Xd ordered(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    ordered.col(i) = points.col(order[static_cast<std::size_t>(i)].second);
  return ordered;
}

}  // namespace palpate::geometry
