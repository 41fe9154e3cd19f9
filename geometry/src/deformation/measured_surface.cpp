// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/measured_surface.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/parallel_for.h"

namespace palpate::geometry {
namespace {

/// A normal is that of the plane fitted to the pixels within this many rows and columns. With
/// direct neighbours alone, the noise of one pixel would turn the normal as much as the surface
/// does.
constexpr Eigen::Index kWindow = 2;
/// Pixels are used if their depth differs by at most this factor times their lateral distance. The
/// others lie on another surface, as surfaces are this steep only at grazing incidence.
constexpr double kMaxSlope = 4;
/// A normal needs at least this many of the 25 pixels: a straight edge leaves 15, a corner 9.
constexpr int kMinPixels = 12;
/// Pixels determine a plane iff the determinant of their scatter matrix exceeds this fraction of
/// the square of its trace.
constexpr double kMinSpread = 1e-3;

/// A pixel is at a border if those of its surface within this many rows and columns lie to one side
/// of it: their mean is further than kMaxOffCentre from it. Sensors with windows of several pixels,
/// such as those for fringes, mix both sides there: depths of decoded frames were wrong by 1 mm up
/// to four pixels from an edge, and pulled a surface 2 mm along itself. Holes of single pixels and
/// thin surfaces, which have borders on both sides, are not affected.
constexpr Eigen::Index kBorder = 4;
constexpr double kMaxOffCentre = 0.35;  // px; 0.5 if the edge is within kBorder - 1

/// The camera sees a point iff the ray of its pixel passes it within this many pixels. Otherwise
/// the distortion model folds back there.
constexpr double kMaxPixelOffset = 2;

}  // namespace

MeasuredSurface::MeasuredSurface(const RangeMap& map)
    : camera_(map.camera), points_(back_project(map)) {
  rays_ = pixel_rays(camera_);
  // Depths that are not positive are unknown.
  for (Eigen::Index i = 0; i < points_.cols(); ++i) {
    if (!(points_(2, i) > 0) || !points_.col(i).allFinite()) {
      points_.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  normals_.resize(3, points_.cols());
  at_border_.resize(static_cast<std::size_t>(points_.cols()));
  parallel_for(map.z.rows(), [&](Eigen::Index row) {
    for (Eigen::Index col = 0; col < map.z.cols(); ++col) {
      fit_normal(row, col);
      find_border(row, col);
    }
  });
}

int MeasuredSurface::pixel_of(const Eigen::Vector3d& point, int before) const {
  if (!(point.z() > 0)) return -1;
  const Eigen::Vector2d normalized = point.hnormalized();
  const Eigen::Vector2d image = distort(camera_, normalized);
  if (before >= 0) {
    const Eigen::Vector2d centre(before % camera_.width, before / camera_.width);
    if ((image - centre).lpNorm<Eigen::Infinity>() <= 1) return before;
  }
  const Eigen::Array2d nearest = image.array().round();
  if (!(nearest.x() >= 0 && nearest.x() < camera_.width && nearest.y() >= 0 &&
        nearest.y() < camera_.height)) {
    return -1;
  }
  const int pixel = static_cast<int>(nearest.y()) * camera_.width + static_cast<int>(nearest.x());
  const Eigen::Array2d offset = (rays_.col(pixel) - normalized).array();
  const Eigen::Array2d offset_px = offset * Eigen::Array2d(camera_.fx, camera_.fy);
  return (offset_px.abs() <= kMaxPixelOffset).all() ? pixel : -1;
}

/// Calls `visit(row, col, pixel)` for the pixels of the same surface around a pixel with a depth.
template <typename Visit>
void MeasuredSurface::visit_neighbours(Eigen::Index row, Eigen::Index col, Eigen::Index window,
                                       Visit&& visit) const {
  const Eigen::Index pixel = row * camera_.width + col;
  const double depth = points_(2, pixel);
  const Eigen::Index last_row = std::min<Eigen::Index>(row + window, camera_.height - 1);
  const Eigen::Index last_col = std::min<Eigen::Index>(col + window, camera_.width - 1);
  for (Eigen::Index r = std::max<Eigen::Index>(row - window, 0); r <= last_row; ++r) {
    for (Eigen::Index c = std::max<Eigen::Index>(col - window, 0); c <= last_col; ++c) {
      const Eigen::Index other = r * camera_.width + c;
      const double across = (rays_.col(other) - rays_.col(pixel)).norm() * depth;
      if (std::abs(points_(2, other) - depth) <= kMaxSlope * across) visit(r, c, other);
    }
  }
}

void MeasuredSurface::find_border(Eigen::Index row, Eigen::Index col) {
  const Eigen::Index pixel = row * camera_.width + col;
  if (std::isnan(points_(2, pixel))) return;
  int count = 0;
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  visit_neighbours(row, col, kBorder, [&](Eigen::Index r, Eigen::Index c, Eigen::Index) {
    ++count;
    sum += Eigen::Array2d(static_cast<double>(r - row), static_cast<double>(c - col));
  });
  at_border_[static_cast<std::size_t>(pixel)] = sum.matrix().norm() > kMaxOffCentre * count;
}

/// A plane is linear in inverse depth over normalised image coordinates: a X + b Y + c Z = 1 is
/// 1 / Z = a x + b y + c, and (a, b, c) is along its normal. Least squares over the window.
void MeasuredSurface::fit_normal(Eigen::Index row, Eigen::Index col) {
  const Eigen::Index pixel = row * camera_.width + col;
  normals_.col(pixel).setConstant(std::numeric_limits<double>::quiet_NaN());
  const double depth = points_(2, pixel);
  if (std::isnan(depth)) return;
  const Eigen::Vector2d ray = rays_.col(pixel);
  int count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // of (x, y, 1 / Z), relative to the pixel's own
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  visit_neighbours(row, col, kWindow, [&](Eigen::Index, Eigen::Index, Eigen::Index other) {
    const Eigen::Vector3d place(rays_(0, other) - ray.x(), rays_(1, other) - ray.y(),
                                1 / points_(2, other) - 1 / depth);
    ++count;
    sum += place;
    products += place * place.transpose();
  });
  if (count < kMinPixels) return;
  const Eigen::Vector3d mean = sum / count;
  const Eigen::Matrix3d spread = products - sum * mean.transpose();
  const Eigen::Matrix2d plane_spread = spread.topLeftCorner<2, 2>();
  const double determinant = plane_spread.determinant();
  const double trace = plane_spread.trace();
  if (!(determinant > kMinSpread * trace * trace)) return;
  const Eigen::Vector2d slope = plane_spread.inverse() * spread.topRightCorner<2, 1>();
  const Eigen::Vector2d middle = ray + mean.head<2>();
  const double constant = 1 / depth + mean.z() - slope.dot(middle);
  normals_.col(pixel) = -Eigen::Vector3d(slope.x(), slope.y(), constant).normalized();
}

}  // namespace palpate::geometry
