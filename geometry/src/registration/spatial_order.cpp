// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/spatial_order.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "query/morton_curve.h"

namespace palpate::geometry {
namespace {

constexpr double kCellsPerAxis = 1024;

}  // namespace

Eigen::Matrix3Xd in_spatial_order(const Eigen::Matrix3Xd& points) {
  if (points.cols() == 0) return points;
  const Eigen::Vector3d lowest = points.rowwise().minCoeff();
  const double size = (points.rowwise().maxCoeff() - lowest).maxCoeff();
  if (!(size > 0) || !std::isfinite(size)) return points;
  std::vector<OnMortonCurve> curve;
  curve.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Array3d cell = (points.col(i) - lowest) / size * kCellsPerAxis;
    curve.push_back({.place = morton_place(cell.min(kCellsPerAxis - 1).cast<std::uint32_t>()),
                     .index = static_cast<int>(i)});
  }
  curve = sorted(std::move(curve));
  Eigen::Matrix3Xd ordered(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    ordered.col(i) = points.col(curve[static_cast<std::size_t>(i)].index);
  return ordered;
}

}  // namespace palpate::geometry
