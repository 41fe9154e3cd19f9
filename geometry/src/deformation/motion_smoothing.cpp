// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/motion_smoothing.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

/// Terms of the parabola.
constexpr Eigen::Index kTerms = 3;

/// Of a frame, relative to that of one at the centre. Frames with less do not determine a
/// deviation.
constexpr double kLeastFrameWeight = 1e-4;

double weight_at(double time, double centre, double window) {
  const double distance = std::min(1.0, std::abs(time - centre) / window);
  const double weight = std::pow(1 - std::pow(distance, 3), 3);
  return weight < kLeastFrameWeight ? 0 : weight;
}

/// What maps n measurements to a parabola: its coefficients in units of the window, and how the
/// scatter about it tells the variance of a measurement.
struct ParabolaFit {
  Eigen::MatrixXd basis;         // n x 3
  Eigen::MatrixXd coefficients;  // 3 x n
  Eigen::VectorXd weights;       // n
  double freedom = 0;            // expected weighted square sum of residuals at variance 1
};

ParabolaFit fit_of(const std::vector<double>& times, double time, double window) {
  const auto count = static_cast<Eigen::Index>(times.size());
  ParabolaFit fit{.basis = Eigen::MatrixXd(count, kTerms),
                  .coefficients = {},
                  .weights = Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = times[static_cast<std::size_t>(i)];
    const double from = (at - time) / window;
    fit.basis.row(i) << 1, from, from * from;
    fit.weights[i] = weight_at(at, time, window);
  }
  const Eigen::VectorXd roots = fit.weights.cwiseSqrt();
  const Eigen::MatrixXd weighted = roots.asDiagonal() * fit.basis;
  fit.coefficients = weighted.colPivHouseholderQr().solve(Eigen::MatrixXd(roots.asDiagonal()));
  const Eigen::MatrixXd residuals =
      Eigen::MatrixXd::Identity(count, count) - fit.basis * fit.coefficients;
  fit.freedom = (residuals.transpose() * fit.weights.asDiagonal() * residuals).trace();
  return fit;
}

void check_times(std::size_t frames, std::span<const double> times) {
  if (frames != times.size()) {
    throw InvalidInput("smooth_motion(): there are " + std::to_string(frames) + " frames and " +
                       std::to_string(times.size()) + " times; each frame must have one");
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    require("smooth_motion(): times", times[i], finite(), "s");
    if (i > 0 && !(times[i] > times[i - 1])) {
      throw InvalidInput("smooth_motion(): times: number " + std::to_string(i) + ", " +
                         std::to_string(times[i]) +
                         " s, is not later than the one before; times must ascend");
    }
  }
}

}  // namespace

int frames_in_window(std::span<const double> times, double time, double window) {
  return static_cast<int>(
      std::ranges::count_if(times, [&](double at) { return weight_at(at, time, window) > 0; }));
}

SmoothedMotion smooth_motion(std::span<const Eigen::Matrix3Xd> frames,
                             std::span<const double> times, double time, double window) {
  require("smooth_motion(): time", time, finite(), "s");
  require("smooth_motion(): window", window, above(0).finite(), "s");
  check_times(frames.size(), times);
  std::vector<const Eigen::Matrix3Xd*> near;
  std::vector<double> near_times;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!(weight_at(times[i], time, window) > 0)) continue;
    near.push_back(&frames[i]);
    near_times.push_back(times[i]);
    if (frames[i].cols() != near.front()->cols()) {
      throw InvalidInput("smooth_motion(): frame " + std::to_string(i) + " has " +
                         std::to_string(frames[i].cols()) + " vertices; those before it have " +
                         std::to_string(near.front()->cols()));
    }
    if (!frames[i].allFinite()) {
      throw InvalidInput("smooth_motion(): frame " + std::to_string(i) +
                         " has a position that is not finite");
    }
  }
  if (near.size() < static_cast<std::size_t>(kFewestSmoothedFrames)) {
    throw InvalidInput("smooth_motion(): the window has " + std::to_string(near.size()) +
                       " frames; at least " + std::to_string(kFewestSmoothedFrames) +
                       " are needed. Give a longer window");
  }
  const ParabolaFit fit = fit_of(near_times, time, window);
  const Eigen::Matrix3Xd& origin = *near.front();  // near it, digits are not lost
  const Eigen::Index vertices = origin.cols();
  std::vector<Eigen::Matrix3Xd> terms(kTerms, Eigen::Matrix3Xd::Zero(3, vertices));
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (Eigen::Index term = 0; term < kTerms; ++term) {
      terms[static_cast<std::size_t>(term)] +=
          fit.coefficients(term, static_cast<Eigen::Index>(i)) * (*near[i] - origin);
    }
  }
  Eigen::RowVectorXd scatter = Eigen::RowVectorXd::Zero(vertices);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    scatter += fit.weights[row] * (*near[i] - origin - terms[0] - fit.basis(row, 1) * terms[1] -
                                   fit.basis(row, 2) * terms[2])
                                      .colwise()
                                      .squaredNorm();
  }
  const double of_variance = fit.coefficients.row(0).squaredNorm() / (3 * fit.freedom);
  return {.positions = origin + terms[0],
          .velocity = terms[1] / window,
          .sigma = (scatter * of_variance).cwiseSqrt().transpose()};
}

}  // namespace palpate::geometry
