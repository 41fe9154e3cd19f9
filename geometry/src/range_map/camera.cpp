// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "range_map/pixel_rays.h"

namespace palpate::geometry {
namespace {

// Newton's method squares the error in every step: after a step of at most this (relative to the
// length of the homogeneous coordinates) only rounding error remains.
constexpr double kMaxLastStep = 1e-8;
constexpr int kMaxNewtonSteps = 20;
// Fixed-point steps bring the start near enough for every lens whose image is not folded.
constexpr int kFixedPointSteps = 2;
// Number of places between the axis and the solution at which the lens is tested for folds.
constexpr int kFoldTests = 4;
// Pixels undistorted together: as many as fit into the registers of every x86-64.
constexpr int kLanes = 2;
// Rows of rays from which the next is predicted.
constexpr int kRowsBefore = 4;

bool has_distortion(const Camera& camera) {
  return std::any_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double k) { return k != 0; });
}

/// One number for each of `n` points, which are undistorted together by vector instructions.
template <int n>
using PerPoint = Eigen::Array<double, n, 1>;

/// Normalised coordinates of `n` points.
template <int n>
struct Points {
  PerPoint<n> x;
  PerPoint<n> y;
};

/// Distortion of normalised coordinates and its derivative, a symmetric matrix.
template <int n>
struct Distortion {
  Points<n> value;
  PerPoint<n> dx_dx, dx_dy, dy_dy;
  PerPoint<n> radial;  ///< factor of the radial part; a pole or a fold makes it <= 0
};

template <int n>
Distortion<n> distort_normalized(const Camera& camera, const Points<n>& p) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  const PerPoint<n>& x = p.x;
  const PerPoint<n>& y = p.y;
  const PerPoint<n> r2 = x * x + y * y;
  const PerPoint<n> numerator = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const PerPoint<n> denominator = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const PerPoint<n> numerator_slope = k1 + r2 * (2 * k2 + r2 * (3 * k3));  // d / d r2
  const PerPoint<n> denominator_slope = k4 + r2 * (2 * k5 + r2 * (3 * k6));
  const PerPoint<n> scale = 1 / denominator;
  const PerPoint<n> radial = numerator * scale;
  const PerPoint<n> radial_slope = (numerator_slope - radial * denominator_slope) * scale;

  Distortion<n> result;
  result.radial = (denominator > 0).select(radial, PerPoint<n>::Constant(-1));
  result.value = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                  y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  result.dx_dx = radial + 2 * x * x * radial_slope + 2 * p1 * y + 6 * p2 * x;
  result.dx_dy = 2 * x * y * radial_slope + 2 * p1 * x + 2 * p2 * y;
  result.dy_dy = radial + 2 * y * y * radial_slope + 6 * p1 * y + 2 * p2 * x;
  return result;
}

template <int n>
PerPoint<n> determinant(const Distortion<n>& at) {
  return at.dx_dx * at.dy_dy - at.dx_dy * at.dx_dy;
}

/// Returns true if the lens surely has no fold between the axis and a point at the square `r2` of
/// its distance from it: its Jacobian there differs from the identity by less than 1 (in the
/// spectral norm), as the sum of the norms of its terms does.
bool surely_unfolded(const Camera& camera, double r2) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  if (k4 != 0 || k5 != 0 || k6 != 0) return false;
  const double radial = r2 * (3 * std::abs(k1) + r2 * (5 * std::abs(k2) + r2 * 7 * std::abs(k3)));
  return radial + 8 * (std::abs(p1) + std::abs(p2)) * std::sqrt(r2) < 1;
}

/// Beyond a fold the lens model shows another place at the same pixel. Only the place connected to
/// the axis without a fold is real; up to the fold the lens is one-to-one and
/// orientation-preserving.
template <int n>
bool all_unfolded(const Camera& camera, const Points<n>& p) {
  if (surely_unfolded(camera, (p.x * p.x + p.y * p.y).maxCoeff())) return true;
  for (int test = 1; test <= kFoldTests; ++test) {
    const double fraction = static_cast<double>(test) / kFoldTests;
    const Distortion<n> at = distort_normalized<n>(camera, {fraction * p.x, fraction * p.y});
    if (!(at.radial > 0 && determinant(at) > 0).all()) return false;
  }
  return true;
}

/// Refines starts to the places that the lens shows at `distorted`; false if this fails for any.
template <int n>
bool undistort_normalized(const Camera& camera, const Points<n>& distorted, Points<n>& p) {
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const Distortion<n> at = distort_normalized(camera, p);
    const PerPoint<n> miss_x = distorted.x - at.value.x;
    const PerPoint<n> miss_y = distorted.y - at.value.y;
    const PerPoint<n> scale = 1 / determinant(at);
    const PerPoint<n> move_x = (at.dy_dy * miss_x - at.dx_dy * miss_y) * scale;
    const PerPoint<n> move_y = (at.dx_dx * miss_y - at.dx_dy * miss_x) * scale;
    p.x += move_x;
    p.y += move_y;
    const PerPoint<n> moved = move_x * move_x + move_y * move_y;
    const PerPoint<n> enough = kMaxLastStep * kMaxLastStep * (1 + p.x * p.x + p.y * p.y);
    if ((moved <= enough).all()) return all_unfolded(camera, p);
    if (!moved.isFinite().all()) return false;
  }
  return false;
}

/// A place close to the one that the lens shows at `distorted`.
Points<1> fixed_point_start(const Camera& camera, const Points<1>& distorted) {
  Points<1> p = distorted;
  for (int step = 0; step < kFixedPointSteps; ++step) {
    const Distortion<1> at = distort_normalized(camera, p);
    if (!(at.radial > 0).all()) break;
    p.x += (distorted.x - at.value.x) / at.radial;
    p.y += (distorted.y - at.value.y) / at.radial;
  }
  return p;
}

Eigen::Vector2d to_normalized(const Camera& camera, const Eigen::Vector2d& pixel) {
  return {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy};
}

/// Rays of `kLanes` pixels from (row, col) on. The rays above predict them so well that one step of
/// Newton's method is enough.
void continue_rays(const Camera& camera, int row, int col,
                   Eigen::Ref<Eigen::Matrix2Xd, 0, Eigen::OuterStride<>> rays) {
  const Eigen::Index first = Eigen::Index{row} * camera.width + col;
  const auto above = [&](int rows, int axis) -> PerPoint<kLanes> {
    return rays.row(axis).segment<kLanes>(first - Eigen::Index{rows} * camera.width).transpose();
  };
  const auto predicted = [&](int axis) -> PerPoint<kLanes> {  // by the cubic through four rows
    return 4 * (above(1, axis) + above(3, axis)) - 6 * above(2, axis) - above(4, axis);
  };
  Points<kLanes> p = {predicted(0), predicted(1)};
  const Points<kLanes> distorted = {
      (PerPoint<kLanes>::LinSpaced(col, col + kLanes - 1) - camera.cx) / camera.fx,
      PerPoint<kLanes>::Constant((row - camera.cy) / camera.fy)};
  if (undistort_normalized(camera, distorted, p)) {
    rays.row(0).segment<kLanes>(first) = p.x;
    rays.row(1).segment<kLanes>(first) = p.y;
    return;
  }
  for (int lane = 0; lane < kLanes; ++lane)
    rays.col(first + lane) = undistort(camera, {col + lane, row});
}

}  // namespace

void check_camera(const Camera& camera, const char* what) {
  const std::string name(what);
  require(name + ": width", camera.width, at_least(1), "px");
  require(name + ": height", camera.height, at_least(1), "px");
  if (std::int64_t{camera.width} * camera.height > kMaxPixels)
    throw InvalidInput(name + ": size is " + std::to_string(camera.width) + " x " +
                       std::to_string(camera.height) + " px; it must be at most 2^28 pixels");
  require(name + ": fx", camera.fx, above(0).finite(), "px");
  require(name + ": fy", camera.fy, above(0).finite(), "px");
  require(name + ": cx", camera.cx, finite(), "px");
  require(name + ": cy", camera.cy, finite(), "px");
  for (std::size_t i = 0; i < camera.distortion.size(); ++i)
    require(name + ": distortion coefficient " + std::to_string(i) +
                " (of k1 k2 p1 p2 k3 k4 k5 k6, from 0)",
            camera.distortion[i], finite());
}

Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& normalized) {
  const Points<1> p = {normalized.row(0), normalized.row(1)};
  const Points<1> distorted = distort_normalized(camera, p).value;
  return {camera.fx * distorted.x[0] + camera.cx, camera.fy * distorted.y[0] + camera.cy};
}

Eigen::Vector2d undistort(const Camera& camera, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d normalized = to_normalized(camera, pixel);
  if (!has_distortion(camera)) return normalized;
  const Points<1> distorted = {normalized.row(0), normalized.row(1)};
  Points<1> p = fixed_point_start(camera, distorted);
  if (undistort_normalized(camera, distorted, p)) return {p.x[0], p.y[0]};
  return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

void fill_pixel_rays(const Camera& camera,
                     Eigen::Ref<Eigen::Matrix2Xd, 0, Eigen::OuterStride<>> rays) {
  const bool distorted = has_distortion(camera);
  // Blocks of fixed width: which columns are solved side by side never depends on the threads.
  constexpr int kBlock = 16 * kLanes;
  parallel_for((camera.width + kBlock - 1) / kBlock, [&](int block) {
    const int end = std::min(camera.width, (block + 1) * kBlock);
    for (int row = 0; row < camera.height; ++row) {
      int col = block * kBlock;
      if (distorted && row >= kRowsBefore) {
        for (; col + kLanes <= end; col += kLanes) continue_rays(camera, row, col, rays);
      }
      for (; col < end; ++col) {
        rays.col(Eigen::Index{row} * camera.width + col) =
            distorted ? undistort(camera, {col, row}) : to_normalized(camera, {col, row});
      }
    }
  });
}

Eigen::Matrix2Xd pixel_rays(const Camera& camera) {
  check_camera(camera, "camera");
  Eigen::Matrix2Xd rays(2, Eigen::Index{camera.width} * camera.height);
  fill_pixel_rays(camera, rays);
  return rays;
}

}  // namespace palpate::geometry
