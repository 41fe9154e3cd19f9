// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_smoothing.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"

namespace palpate::geometry {
namespace {

constexpr int kMostRadius = 15;
constexpr int kReweightings = 3;
/// One surface explains a window iff the mean square of its residuals, in units of their
/// deviations, is at most this. With noise as predicted it is 1 with a spread of 0.2 (49 pixels);
/// deviations that are predicted too small by a factor of 0.7 still pass.
constexpr double kGoodFit = 2;
/// A fit is trusted iff the smallest pivot of its normal equations is at least this fraction of the
/// largest. The window's coordinates are scaled to [-1, 1], so only known pixels whose arrangement
/// does not determine the surface (a line, a corner) come close to this limit.
constexpr double kLeastPivot = 1e-4;

using Row6 = Eigen::Matrix<double, 6, 1>;

/// A known pixel of the window.
struct Neighbour {
  Row6 basis;          ///< 1, x, y, x^2, x y, y^2 with x and y from -1 to 1
  double inverse = 0;  ///< 1 / z minus that of the middle
  double sigma = 0;    ///< of `inverse`
  double weight = 0;
};

void check(const ImageF& z, const ImageF& sigma, const RangeMapSmoothingOptions& options) {
  if (z.rows() != sigma.rows() || z.cols() != sigma.cols()) {
    throw InvalidInput("smooth_range_map: depths are " + std::to_string(z.cols()) + " x " +
                       std::to_string(z.rows()) + " px, their deviations " +
                       std::to_string(sigma.cols()) + " x " + std::to_string(sigma.rows()) +
                       "; both have to be of one frame");
  }
  static_cast<void>(in_range(options));
}

bool is_usable(float z, float sigma) {
  return z > 0 && std::isfinite(z) && sigma > 0 && std::isfinite(sigma);
}

double biweight(double residual, double limit) {
  const double ratio = residual / limit;
  if (!(std::abs(ratio) < 1)) return 0;
  const double factor = 1 - ratio * ratio;
  return factor * factor;
}

/// Smooths one pixel after another; holds the window.
class Smoother {
 public:
  Smoother(const ImageF& z, const ImageF& sigma, const RangeMapSmoothingOptions& options)
      : z_(z), sigma_(sigma), options_(options) {}

  float smoothed(Eigen::Index row, Eigen::Index col) {
    const float z = z_(row, col);
    if (!is_usable(z, sigma_(row, col))) return z;
    gather(row, col);
    std::optional<Row6> surface = fit();
    if (surface && mean_square(*surface) > kGoodFit) surface = fit_one_side();
    if (!surface) return z;
    const auto depth = static_cast<double>(z);
    const double most = options_.max_move * static_cast<double>(sigma_(row, col));
    const double moved = 1 / (1 / depth + (*surface)[0]);
    return static_cast<float>(std::clamp(moved, depth - most, depth + most));
  }

 private:
  /// All known pixels around, each with the weight of its variance.
  void gather(Eigen::Index row, Eigen::Index col) {
    window_.clear();
    const double middle = 1 / static_cast<double>(z_(row, col));
    const Eigen::Index radius = options_.radius_px;
    const double scale = 1 / static_cast<double>(radius);
    for (Eigen::Index v = std::max<Eigen::Index>(row - radius, 0);
         v <= std::min(row + radius, z_.rows() - 1); ++v) {
      for (Eigen::Index u = std::max<Eigen::Index>(col - radius, 0);
           u <= std::min(col + radius, z_.cols() - 1); ++u) {
        if (!is_usable(z_(v, u), sigma_(v, u))) continue;
        const double inverse = 1 / static_cast<double>(z_(v, u));
        const double x = static_cast<double>(u - col) * scale;
        const double y = static_cast<double>(v - row) * scale;
        Neighbour n;
        n.basis << 1, x, y, x * x, x * y, y * y;
        n.inverse = inverse - middle;
        n.sigma = static_cast<double>(sigma_(v, u)) * inverse * inverse;
        n.weight = 1 / (n.sigma * n.sigma);
        window_.push_back(n);
      }
    }
  }

  /// If the window contains more than one surface, the middle belongs to the half that is most
  /// planar. Starting from there, pixels that fit are added.
  std::optional<Row6> fit_one_side() {
    std::optional<Row6> surface;
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [axis, side] : {std::pair(1, -1), {1, 1}, {2, -1}, {2, 1}}) {
      for (Neighbour& n : window_)
        n.weight = side * n.basis[axis] >= 0 ? 1 / (n.sigma * n.sigma) : 0;
      const std::optional<Row6> plane = fit_plane();
      const double misfit = plane ? mean_square(*plane) : best;
      if (misfit >= best) continue;
      best = misfit;
      surface = plane;
    }
    for (int pass = 0; surface && pass < kReweightings; ++pass) {
      for (Neighbour& n : window_) {
        const double residual = (n.inverse - surface->dot(n.basis)) / n.sigma;
        n.weight = biweight(residual, options_.max_residual) / (n.sigma * n.sigma);
      }
      surface = fit();
    }
    return surface;
  }

  /// Mean square of the residuals in units of their deviations, over the pixels with a weight.
  [[nodiscard]] double mean_square(const Row6& surface) const {
    double sum = 0, count = 0;
    for (const Neighbour& n : window_) {
      if (n.weight == 0) continue;
      const double residual = (n.inverse - surface.dot(n.basis)) / n.sigma;
      sum += residual * residual;
      ++count;
    }
    return sum / count;
  }

  /// Weighted least squares; of first order if the pixels do not determine a second-order surface.
  [[nodiscard]] std::optional<Row6> fit() const {
    const auto [normal, right] = normal_equations();
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> second(normal);
    if (is_fixed(second.vectorD())) return second.solve(right);
    return fit_plane();
  }

  [[nodiscard]] std::optional<Row6> fit_plane() const {
    const auto [normal, right] = normal_equations();
    const Eigen::LDLT<Eigen::Matrix3d> first(normal.topLeftCorner<3, 3>());
    if (!is_fixed(first.vectorD())) return std::nullopt;
    Row6 surface = Row6::Zero();
    surface.head<3>() = first.solve(right.head<3>());
    return surface;
  }

  [[nodiscard]] std::pair<Eigen::Matrix<double, 6, 6>, Row6> normal_equations() const {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Row6 right = Row6::Zero();
    for (const Neighbour& n : window_) {
      if (n.weight == 0) continue;
      normal.noalias() += n.weight * n.basis * n.basis.transpose();
      right += n.weight * n.inverse * n.basis;
    }
    return {normal, right};
  }

  template <typename Pivots>
  static bool is_fixed(const Pivots& pivots) {
    return pivots.minCoeff() > kLeastPivot * pivots.maxCoeff();
  }

  const ImageF& z_;
  const ImageF& sigma_;
  const RangeMapSmoothingOptions& options_;
  std::vector<Neighbour> window_;
};

}  // namespace

void visit(RangeMapSmoothingOptions& options, FieldVisitor& visitor) {
  constexpr bool kExpert = true;
  visitor.begin("RangeMapSmoothingOptions");
  visitor.whole(
      {"radius_px", "Distance from a depth to the border of the square window of its neighbours",
       "px", kExpert, "smooth-radius"},
      options.radius_px, at_least(1).at_most(kMostRadius));
  visitor.real({"max_residual",
                "A neighbour that is this many standard deviations from the surface through the "
                "others belongs to another surface, and gets no weight",
                "", kExpert, "smooth-residual"},
               options.max_residual, above(0));
  visitor.real({"max_move", "No depth moves by more than this many of its standard deviations", "",
                kExpert, "smooth-move"},
               options.max_move, above(0));
}

ImageF smooth_range_map(const ImageF& z, const ImageF& sigma,
                        const RangeMapSmoothingOptions& options) {
  check(z, sigma, options);
  ImageF result(z.rows(), z.cols());
  parallel_for(z.rows(), [&](Eigen::Index row) {
    Smoother smoother(z, sigma, options);
    for (Eigen::Index col = 0; col < z.cols(); ++col)
      result(row, col) = smoother.smoothed(row, col);
  });
  return result;
}

}  // namespace palpate::geometry
