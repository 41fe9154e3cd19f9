// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/period_count.h"

#include <fmt/format.h>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "image/hue.h"
#include "palpate/core/quantile.h"
#include "setup/rig_jacobian.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

/// Smallest number of cells of a usable region.
constexpr std::size_t kLeastCells = 12;
/// A surface counts as plane if its phase deviates from that of a plane by at most this [rad RMS].
constexpr double kMaxPlaneResidual = 0.3;
/// The number of periods counts as known if its standard deviation is at most this: the nearest
/// whole number is the right one if the error is below half a period, two deviations.
constexpr double kMaxCountDeviation = 0.25;
/// The same if the rig has no covariance: then only the unexplained part of the surface's phases
/// shows how wrong the rig is, in a few directions, and too small a value is frequent.
constexpr double kMaxBlindDeviation = 0.1;
/// Keeps the scale of a column of zeros defined.
constexpr double kTiny = std::numeric_limits<double>::min();
/// This share of the cells with a known depth must give the same number.
constexpr double kLeastAgreement = 0.8;

/// A cell as used in the search for the period.
struct PeriodSample {
  Eigen::Vector3d ray;        ///< (x, y, 1) of the camera
  Eigen::Vector3d direction;  ///< in projector coordinates
  double pixel = 0;           ///< the projector's along the axis, up to whole periods
};

/// Depths for the values of `pixel`; empty if one of them has none.
std::vector<double> depths(const std::vector<PeriodSample>& samples,
                           const Triangulation& triangulation, Axis axis, double more_pixels) {
  std::vector<double> result;
  for (const PeriodSample& sample : samples) {
    const double z = triangulation.depth(sample.direction, axis, sample.pixel + more_pixels);
    if (!(z > 0)) return {};
    result.push_back(z);
  }
  return result;
}

/// Deviation of the samples from their best plane.
struct PlaneFit {
  Eigen::MatrixX3d equations;  ///< of the plane's parameters, one row per sample [rad]
  Eigen::VectorXd residual;    ///< [rad]
};

/// A plane has 1 / z = m . (x, y, 1), which is linear in m, and the phase is nearly linear in 1 /
/// z. Empty if a sample has no depth.
std::optional<PlaneFit> fit_plane(const std::vector<PeriodSample>& samples,
                                  const Triangulation& triangulation, const Pattern& pattern,
                                  double more_pixels) {
  const std::vector<double> z = depths(samples, triangulation, pattern.axis, more_pixels);
  if (z.empty()) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(samples.size());
  PlaneFit fit{Eigen::MatrixX3d(count, 3), Eigen::VectorXd(count)};
  Eigen::VectorXd inverse(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double by_inverse = kFullTurn / pattern.period * z[k] * z[k] *
                              triangulation.slope(samples[k].direction, pattern.axis, z[k]);
    fit.equations.row(i) = by_inverse * samples[k].ray.transpose();
    inverse[i] = by_inverse / z[k];
  }
  fit.residual = inverse - fit.equations * fit.equations.colPivHouseholderQr().solve(inverse);
  return fit;
}

/// Variance, per direction of the residual, that neither the plane nor `change` explains.
struct Unexplained {
  double noise = 0;  ///< over all directions
  /// Over polynomials of the second and third degree: slow errors of a lens, of the rig's
  /// calibration or of the surface, which can be mistaken for a wrong number of periods.
  double slow = 0;
};
Unexplained unexplained(const std::vector<PeriodSample>& samples, const PlaneFit& fit,
                        const Eigen::VectorXd& change) {
  const Eigen::Index count = fit.residual.size();
  constexpr Eigen::Index kTaken = 4;
  constexpr Eigen::Index kPolynomials = 7;
  Eigen::MatrixXd basis(count, kTaken + kPolynomials);
  basis.leftCols(3) = fit.equations;
  basis.col(3) = change;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d& ray = samples[static_cast<std::size_t>(i)].ray;
    const double x = ray.x();
    const double y = ray.y();
    basis.row(i).tail(kPolynomials) << x * x, x * y, y * y, x * x * x, x * x * y, x * y * y,
        y * y * y;
  }
  basis.array().rowwise() /= basis.colwise().norm().array().max(kTiny);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis);
  const Eigen::VectorXd turned = qr.householderQ().transpose() * fit.residual;
  const double slow = turned.segment(kTaken, kPolynomials).squaredNorm() / kPolynomials;
  return {.noise = fit.residual.squaredNorm() / static_cast<double>(count - kTaken), .slow = slow};
}

/// Variance, along `change`, of the residual by the rig's covariance [rad^2].
double variance_by_rig(const std::vector<PeriodSample>& samples, const PlaneFit& fit,
                       const Eigen::VectorXd& change, const std::vector<double>& z, const Rig& rig,
                       const Pattern& pattern) {
  if (!rig.covariance) return 0;
  Eigen::Matrix2Xd pixels(2, samples.size());
  Eigen::VectorXd inverse_depth(samples.size());
  for (Eigen::Index i = 0; i < inverse_depth.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    pixels.col(i) = geometry::distort(rig.camera, samples[k].ray.head<2>());
    inverse_depth[i] = 1 / z[k];
  }
  const PanelView view =
      panel_view(rig, pattern.axis, look_back(rig.camera, pixels), inverse_depth);
  Eigen::MatrixXd by_rig = kFullTurn / pattern.period * view.by_rig;
  if (!by_rig.allFinite()) return 0;
  by_rig -= fit.equations * fit.equations.colPivHouseholderQr().solve(by_rig);
  const Eigen::RowVectorXd along = change.normalized().transpose() * by_rig;
  return (along * *rig.covariance).dot(along);
}

/// The number of periods, or the reason why there is none.
struct Count {
  std::optional<int> periods;
  double deviation = 0;  ///< of the number
  std::string problem;
};

/// The number of periods for which the samples are closest to a plane.
Count count_by_plane(const std::vector<PeriodSample>& samples, const Rig& rig,
                     const Pattern& pattern, int first, int last) {
  const Triangulation triangulation(rig);
  const auto fit = [&](int periods) {
    return fit_plane(samples, triangulation, pattern, periods * pattern.period);
  };
  std::optional<PlaneFit> best;
  int periods = 0;
  for (int k = first; k <= last; ++k) {
    std::optional<PlaneFit> tried = fit(k);
    if (!tried || (best && tried->residual.norm() >= best->residual.norm())) continue;
    best = std::move(tried);
    periods = k;
  }
  if (!best)
    return {{}, 0, "its phase fits no depth in front of the camera; check rig and pattern"};
  const double rms = best->residual.norm() / std::sqrt(static_cast<double>(samples.size()));
  if (rms > kMaxPlaneResidual) {
    return {
        {}, 0, "the surface is not plane; its depths are needed to tell one period from the next"};
  }
  std::optional<PlaneFit> next = fit(periods + 1);
  if (!next) next = fit(periods - 1);
  if (!next) return {periods, 0, {}};  // no other number gives depths
  const Eigen::VectorXd change = next->residual - best->residual;
  const Unexplained rest = unexplained(samples, *best, change);
  const double by_rig = variance_by_rig(
      samples, *best, change,
      depths(samples, triangulation, pattern.axis, periods * pattern.period), rig, pattern);
  const double deviation = std::sqrt(std::max(rest.noise, rest.slow) + by_rig) / change.norm();
  if (!(deviation <= (rig.covariance ? kMaxCountDeviation : kMaxBlindDeviation))) {
    return {{},
            0,
            fmt::format("with this rig a plane tells the number of periods only to +- {:.1f}; its "
                        "depths are needed",
                        deviation)};
  }
  return {periods, deviation, {}};
}

/// The number of periods that follows from known depths.
/// \param missing periods that each sample lacks.
Count count_by_depth(const std::vector<double>& missing) {
  if (missing.empty()) return {{}, 0, "no depth is known where its phase is reliable"};
  const double number = std::round(median(missing));
  const auto agreeing = std::count_if(missing.begin(), missing.end(),
                                      [&](double value) { return std::abs(value - number) <= 1; });
  if (static_cast<double>(agreeing) < kLeastAgreement * static_cast<double>(missing.size())) {
    return {
        {}, 0, "the given depths do not agree on a period; they must be right to about one period"};
  }
  return {static_cast<int>(number), 0, {}};
}

/// The given depth nearest to a cell's centre; NaN if unknown.
double depth_at(const geometry::ImageF& depth, const Eigen::Vector2d& pixel) {
  return static_cast<double>(depth(std::lround(pixel.y()), std::lround(pixel.x())));
}

}  // namespace

PeriodCount count_periods(WhiteView& view, const Carrier& carrier, const Rig& rig,
                          const Pattern& pattern, const std::optional<geometry::ImageF>& depth) {
  const Triangulation triangulation(rig);
  const Eigen::Index axis = pattern.axis == Axis::x ? 0 : 1;
  const int panel = axis == 0 ? rig.projector.width : rig.projector.height;
  std::vector<PhaseCell> counted;
  PeriodCount result{.deviation = 0,
                     .problem = "too few of its pixels are lit, modulated and not saturated"};
  for (int region = 0; region < view.regions; ++region) {
    std::vector<PhaseCell> cells;
    std::copy_if(view.cells.begin(), view.cells.end(), std::back_inserter(cells),
                 [&](const PhaseCell& cell) { return cell.region == region; });
    if (cells.size() < kLeastCells) continue;
    std::vector<PeriodSample> samples;
    std::vector<double> missing;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const PhaseCell& cell : cells) {
      const Eigen::Vector2d place = camera_pixel(cell, carrier);
      PeriodSample sample;
      sample.ray = geometry::undistort(rig.camera, place).homogeneous();
      sample.direction = triangulation.direction(sample.ray.head<2>());
      sample.pixel = (cell.phase - pattern.phase) / kFullTurn * pattern.period;
      lowest = std::min(lowest, sample.pixel);
      highest = std::max(highest, sample.pixel);
      samples.push_back(sample);
      if (!depth) continue;
      const double lit_by = triangulation.project(sample.direction, depth_at(*depth, place))[axis];
      if (std::isfinite(lit_by)) missing.push_back((lit_by - sample.pixel) / pattern.period);
    }
    // The region lies on the panel.
    const int first = static_cast<int>(std::ceil((-0.5 - lowest) / pattern.period));
    const int last = static_cast<int>(std::floor((panel - 0.5 - highest) / pattern.period));
    const Count count =
        depth ? count_by_depth(missing) : count_by_plane(samples, rig, pattern, first, last);
    if (!count.periods) {
      result.problem = count.problem;
      continue;
    }
    result.deviation = std::max(result.deviation, count.deviation);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i].pixel = samples[i].pixel + *count.periods * pattern.period;
      cells[i].depth = triangulation.depth(samples[i].direction, pattern.axis, cells[i].pixel);
      if (cells[i].depth > 0) counted.push_back(cells[i]);
    }
  }
  view.cells = std::move(counted);
  if (!view.cells.empty()) result.problem.clear();
  return result;
}

}  // namespace palpate::sensing
