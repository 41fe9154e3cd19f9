// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surface_detail.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate::bench {
namespace {

/// [px] Half of a window for ripples: the sinusoids of all scenes have some 7 px per period.
constexpr int kRippleRadius = 11;
/// [px] Spacing of the windows, and of the normals.
constexpr int kRippleSpacing = 3;
constexpr int kNormalSpacing = 2;
/// [rad] A phase that changes more from one pixel to the next lies on another surface.
constexpr double kLargestStep = 1.5;
/// [px] Distance of the pixels of a normal from its own.
constexpr int kNormalReach = 2;
/// Depths that differ by more than this share belong to other surfaces.
constexpr double kOtherSurface = 0.01;

using Image = Eigen::ArrayXXd;
constexpr int kTerms = 8;
using Terms = Eigen::Matrix<double, kTerms, 1>;

/// [rad] Phase of the pattern on the true surface, and errors relative to its depth.
struct Errors {
  Image phase, relative;
};

Errors errors_of(const Scene& scene, const View& view, const Eigen::Matrix3Xd& rays,
                 const geometry::ImageF& difference) {
  Errors errors{Image(view.z.rows(), view.z.cols()), Image(view.z.rows(), view.z.cols())};
  const bool along_x = scene.pattern.axis == sensing::Axis::x;
  for (long v = 0; v < view.z.rows(); ++v) {
    for (long u = 0; u < view.z.cols(); ++u) {
      const auto z = static_cast<double>(view.z(v, u));
      const Eigen::Vector3d place =
          scene.rig.T_projector_camera * (rays.col(v * view.z.cols() + u) * z).eval();
      const Eigen::Vector2d pixel = geometry::distort(scene.rig.projector, place.hnormalized());
      errors.phase(v, u) =
          2 * std::numbers::pi * (along_x ? pixel.x() : pixel.y()) / scene.pattern.period;
      errors.relative(v, u) = static_cast<double>(difference(v, u)) / z;
    }
  }
  return errors;
}

/// Mean square of the first harmonic in the window around a pixel; NaN if it is not complete.
double ripple_at(const Errors& errors, long v, long u, bool along_x) {
  Eigen::Matrix<double, kTerms, kTerms> products = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Terms right = Terms::Zero();
  double before = std::numeric_limits<double>::quiet_NaN();
  for (int k = -kRippleRadius; k <= kRippleRadius; ++k) {
    const long row = along_x ? v : v + k;
    const long column = along_x ? u + k : u;
    const double phase = errors.phase(row, column);
    const double error = errors.relative(row, column);
    if (std::isnan(error) || std::abs(phase - before) > kLargestStep) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    before = phase;
    const double x = k / static_cast<double>(kRippleRadius);
    const double weight = 0.5 + 0.5 * std::cos(std::numbers::pi * k / (kRippleRadius + 1));
    Terms terms;
    terms << 1, x, x * x, x * x * x, std::cos(phase), std::sin(phase), std::cos(2 * phase),
        std::sin(2 * phase);
    products += weight * terms * terms.transpose();
    right += weight * error * terms;
  }
  const Terms fit = products.ldlt().solve(right);
  return (fit[4] * fit[4] + fit[5] * fit[5]) / 2;
}

}  // namespace

void SurfaceDetail::add(const Scene& scene, const View& view, const geometry::ImageF& difference) {
  const long rows = view.z.rows();
  const long columns = view.z.cols();
  const Eigen::Matrix3Xd rays = geometry::pixel_rays(scene.rig.camera).colwise().homogeneous();
  const Errors errors = errors_of(scene, view, rays, difference);
  const bool along_x = scene.pattern.axis == sensing::Axis::x;
  const long beside = along_x ? 0 : kRippleRadius;
  const long ahead = along_x ? kRippleRadius : 0;
  for (long v = beside; v < rows - beside; v += kRippleSpacing) {
    for (long u = ahead; u < columns - ahead; u += kRippleSpacing) {
      const double ripple = ripple_at(errors, v, u, along_x);
      if (std::isnan(ripple)) continue;
      squares_ += ripple;
      ++windows_;
    }
  }
  const auto normal = [&](const auto& depth, long v, long u) {
    const auto point = [&](long row, long column) {
      return Eigen::Vector3d(rays.col(row * columns + column) * depth(row, column));
    };
    return (point(v, u + kNormalReach) - point(v, u - kNormalReach))
        .cross(point(v + kNormalReach, u) - point(v - kNormalReach, u))
        .normalized()
        .eval();
  };
  const auto truth = [&](long v, long u) { return static_cast<double>(view.z(v, u)); };
  const auto measured = [&](long v, long u) {
    return truth(v, u) + static_cast<double>(difference(v, u));
  };
  const auto usable = [&](long v, long u, double z) {
    return !std::isnan(errors.relative(v, u)) && std::abs(truth(v, u) - z) < kOtherSurface * z;
  };
  for (long v = kNormalReach; v < rows - kNormalReach; v += kNormalSpacing) {
    for (long u = kNormalReach; u < columns - kNormalReach; u += kNormalSpacing) {
      const double z = truth(v, u);
      if (!usable(v - kNormalReach, u, z) || !usable(v + kNormalReach, u, z) ||
          !usable(v, u - kNormalReach, z) || !usable(v, u + kNormalReach, z)) {
        continue;
      }
      const Eigen::Vector3d a = normal(measured, v, u), b = normal(truth, v, u);
      angles_.push_back(std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi);
    }
  }
}

double SurfaceDetail::ripple() const {
  return 100 * std::sqrt(squares_ / static_cast<double>(windows_));
}

double SurfaceDetail::normals() const {
  if (angles_.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted = angles_;
  const auto middle = sorted.begin() + static_cast<long>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace palpate::bench
