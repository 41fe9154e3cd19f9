// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/camera.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "palpate/error.h"

namespace palpate::geometry {
namespace {

// Newton's method squares the error in every step: after a step of at most this (relative to the
// length of the homogeneous coordinates) what is left is rounding.
constexpr double kMaxLastStep = 1e-8;
constexpr int kMaxNewtonSteps = 20;
// Fixed-point steps bring the start near enough for every lens whose image is not folded.
constexpr int kFixedPointSteps = 2;
// The lens is tested for folds at so many places between the axis and the solution.
constexpr int kFoldTests = 4;

// More pixels are no camera's: pixels are counted in int, and each costs some 100 bytes.
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

bool has_distortion(const Camera& camera) {
  return std::any_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double k) { return k != 0; });
}

/// Distortion of normalised coordinates and its derivative.
struct Distortion {
  Eigen::Vector2d value;
  Eigen::Matrix2d jacobian;
  double radial;  ///< factor of the radial part; a pole or a fold makes it <= 0
};

Distortion distort_normalized(const Camera& camera, const Eigen::Vector2d& p) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double numerator = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double denominator = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double numerator_slope = k1 + r2 * (2 * k2 + r2 * 3 * k3);  // d / d r2
  const double denominator_slope = k4 + r2 * (2 * k5 + r2 * 3 * k6);
  const double scale = 1 / denominator;
  const double radial = numerator * scale;
  const double radial_slope = (numerator_slope - radial * denominator_slope) * scale;

  Distortion result;
  result.radial = denominator > 0 ? radial : -1;
  result.value = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                  y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  const double mixed = 2 * x * y * radial_slope + 2 * p1 * x + 2 * p2 * y;
  result.jacobian << radial + 2 * x * x * radial_slope + 2 * p1 * y + 6 * p2 * x, mixed,  //
      mixed, radial + 2 * y * y * radial_slope + 6 * p1 * y + 2 * p2 * x;
  return result;
}

/// Whether the lens maps a neighbourhood of `p` one to one and without a mirror image.
bool invertible(const Distortion& at) { return at.radial > 0 && at.jacobian.determinant() > 0; }

/// Whether the lens surely has no fold between the axis and `p`: its Jacobian there differs from
/// the identity by less than 1 (in the spectral norm), as the sum of the norms of its terms does.
bool surely_unfolded(const Camera& camera, const Eigen::Vector2d& p) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  if (k4 != 0 || k5 != 0 || k6 != 0) return false;
  const double r2 = p.squaredNorm();
  const double radial = r2 * (3 * std::abs(k1) + r2 * (5 * std::abs(k2) + r2 * 7 * std::abs(k3)));
  return radial + 8 * (std::abs(p1) + std::abs(p2)) * std::sqrt(r2) < 1;
}

/// Beyond a fold the lens model shows another place at the same pixel; only the one that is joined
/// to the axis without a fold is real.
bool unfolded(const Camera& camera, const Eigen::Vector2d& p) {
  if (surely_unfolded(camera, p)) return true;
  for (int test = 1; test <= kFoldTests; ++test) {
    const double fraction = static_cast<double>(test) / kFoldTests;
    if (!invertible(distort_normalized(camera, fraction * p))) return false;
  }
  return true;
}

/// A place near the one that the lens shows at `distorted`.
Eigen::Vector2d fixed_point_start(const Camera& camera, const Eigen::Vector2d& distorted) {
  Eigen::Vector2d p = distorted;
  for (int step = 0; step < kFixedPointSteps; ++step) {
    const Distortion at = distort_normalized(camera, p);
    if (!(at.radial > 0)) break;
    p += (distorted - at.value) / at.radial;
  }
  return p;
}

/// The place that the lens shows at `distorted`, searched from `start`; NaN if there is none.
Eigen::Vector2d undistort_normalized(const Camera& camera, const Eigen::Vector2d& distorted,
                                     const Eigen::Vector2d& start) {
  Eigen::Vector2d p = start;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const Distortion at = distort_normalized(camera, p);
    const Eigen::Vector2d move = at.jacobian.inverse() * (distorted - at.value);
    p += move;
    if (!p.allFinite()) break;
    if (move.squaredNorm() > kMaxLastStep * kMaxLastStep * (1 + p.squaredNorm())) continue;
    if (unfolded(camera, p)) return p;
    break;
  }
  return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

Eigen::Vector2d to_normalized(const Camera& camera, const Eigen::Vector2d& pixel) {
  return {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy};
}

}  // namespace

void check_camera(const Camera& camera, const char* what) {
  const std::string name(what);
  if (camera.width <= 0 || camera.height <= 0)
    throw InvalidInput(name + ": size is " + std::to_string(camera.width) + " x " +
                       std::to_string(camera.height) + " px; both must be positive");
  if (std::int64_t{camera.width} * camera.height > kMaxPixels)
    throw InvalidInput(name + ": size is " + std::to_string(camera.width) + " x " +
                       std::to_string(camera.height) + " px; at most 2^28 pixels can be used");
  if (!std::isfinite(camera.fx) || !std::isfinite(camera.fy) || camera.fx <= 0 || camera.fy <= 0)
    throw InvalidInput(name + ": focal lengths are " + std::to_string(camera.fx) + ", " +
                       std::to_string(camera.fy) + " px; both must be positive and finite");
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy))
    throw InvalidInput(name + ": principal point is " + std::to_string(camera.cx) + ", " +
                       std::to_string(camera.cy) + " px; both must be finite");
  for (std::size_t i = 0; i < camera.distortion.size(); ++i)
    if (!std::isfinite(camera.distortion[i]))
      throw InvalidInput(name + ": distortion coefficient " + std::to_string(i) +
                         " (of k1 k2 p1 p2 k3 k4 k5 k6, from 0) is not finite");
}

Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& normalized) {
  const Eigen::Vector2d distorted = distort_normalized(camera, normalized).value;
  return {camera.fx * distorted.x() + camera.cx, camera.fy * distorted.y() + camera.cy};
}

Eigen::Vector2d undistort(const Camera& camera, const Eigen::Vector2d& pixel) {
  if (!has_distortion(camera)) return to_normalized(camera, pixel);
  const Eigen::Vector2d distorted = to_normalized(camera, pixel);
  return undistort_normalized(camera, distorted, fixed_point_start(camera, distorted));
}

Eigen::Matrix2Xd pixel_rays(const Camera& camera) {
  check_camera(camera, "camera");
  const Eigen::Index width = camera.width;
  Eigen::Matrix2Xd rays(2, width * camera.height);
  const bool distorted = has_distortion(camera);
  const auto fill = [&](int row, int col) {
    const Eigen::Index i = row * width + col;
    rays.col(i) = to_normalized(camera, {col, row});
    if (!distorted) return;
    // The two rays above tell this one so well that Newton's method is done in two steps; unlike
    // those on the left, they are long known when the processor gets here.
    Eigen::Vector2d ray = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    if (row > 1)
      ray = undistort_normalized(camera, rays.col(i),
                                 2 * rays.col(i - width) - rays.col(i - 2 * width));
    rays.col(i) = ray.hasNaN() ? undistort(camera, {col, row}) : ray;
  };
  tbb::parallel_for(tbb::blocked_range<int>(0, camera.width), [&](const auto& cols) {
    for (int row = 0; row < camera.height; ++row)
      for (int col = cols.begin(); col < cols.end(); ++col) fill(row, col);
  });
  return rays;
}

}  // namespace palpate::geometry
