// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/friction_axis.h"

#include <Eigen/QR>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/haptics/rotation.h"
#include "palpate/probing/measurable.h"

namespace palpate::haptics {
namespace {

// A pair is used if its components along the cone's axis exceed this multiple of their noise,
// because a noisy denominator biases a ratio.
constexpr double kMinSignal = 5;
// Deviation of the ratios d_T / d_N of a real object from the linear law (about 6 degrees). It
// bounds the weight of pairs with little noise. Sheets deviate by 0.05 to 0.2; all of these values
// give the same axis within 0.03 degrees.
constexpr double kNonlinearity = 0.1;
constexpr double kHuberOfRatios = 2;  // times the robust standard deviation
// The median length of two independent normal numbers of standard deviation 1, sqrt(2 ln 2).
constexpr double kMedianLength = 1.17741;
constexpr int kUnknowns = 3;              // of each component: t and a row of S
constexpr int kMinPairs = 2 * kUnknowns;  // half of them estimate the scatter
constexpr int kMaxReweightings = 50;
constexpr double kRatioTolerance = 1e-10;  // change of the solution between two iterations
// The forces span a plane if the least pivot is larger than this times the largest.
constexpr double kMinPivot = 1e-6;
// [rad] An axis is used if its standard error is at most this (9 degrees). Otherwise the axis of
// the friction cone is used, whose error on a stretched sheet is about as large.
constexpr double kMaxError = 0.15;

// Rows: pairs.
struct Ratios {
  Eigen::MatrixX3d design;    // 1, f_T / f_N
  Eigen::MatrixX2d observed;  // d_T / d_N
  Eigen::ArrayXd weights;     // 1 / standard deviation of `observed`
};

void check(const ForceSamples& samples, const Eigen::Vector3d& cone_axis,
           const FrictionAxisOptions& options) {
  require("FrictionAxisOptions::displacement_noise", options.displacement_noise,
          at_least(0).at_most(probing::kLargestMeasurement), "mm");
  require("FrictionAxisOptions::force_noise", options.force_noise,
          above(0).at_most(probing::kLargestMeasurement), "N");
  if (!(cone_axis.norm() > 0) || !cone_axis.allFinite()) {
    throw InvalidInput("fit_friction_axis(): the cone's axis must be finite and not zero");
  }
  if (samples.forces.cols() != samples.displacements.cols() ||
      samples.forces.cols() != static_cast<Eigen::Index>(samples.kinds.size())) {
    throw InvalidInput("fit_friction_axis(): " + std::to_string(samples.displacements.cols()) +
                       " displacements, " + std::to_string(samples.forces.cols()) + " forces and " +
                       std::to_string(samples.kinds.size()) +
                       " kinds of pairs; there must be as many of each");
  }
}

Ratios ratios_of(const ForceSamples& samples, const Eigen::Vector3d& cone_axis,
                 const FrictionAxisOptions& options) {
  const Eigen::Matrix3d frame = rotation_between(Eigen::Vector3d::UnitZ(), cone_axis);
  const Eigen::Index count = samples.forces.cols();
  Ratios ratios{Eigen::MatrixX3d(count, 3), Eigen::MatrixX2d(count, 2), Eigen::ArrayXd(count)};
  Eigen::Index used = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (samples.kinds[static_cast<std::size_t>(i)] == PairKind::held) continue;
    const Eigen::Vector3d force = frame.transpose() * samples.forces.col(i),
                          displacement = frame.transpose() * samples.displacements.col(i);
    if (!force.allFinite() || !displacement.allFinite()) {
      throw InvalidInput("fit_friction_axis(): pair " + std::to_string(i) +
                         " is not finite; leave it out");
    }
    if (!(displacement.z() > kMinSignal * options.displacement_noise) ||
        !(force.z() > kMinSignal * options.force_noise)) {
      continue;
    }
    ratios.design.row(used) << 1, force.head<2>().transpose() / force.z();
    ratios.observed.row(used) = displacement.head<2>() / displacement.z();
    const double noise =
        options.displacement_noise * displacement.norm() / (displacement.z() * displacement.z());
    ratios.weights[used++] = 1 / std::hypot(kNonlinearity, noise);
  }
  ratios.design.conservativeResize(used, Eigen::NoChange);
  ratios.observed.conservativeResize(used, Eigen::NoChange);
  ratios.weights.conservativeResize(used);
  return ratios;
}

}  // namespace

const char* to_string(FrictionAxisStop stop) {
  switch (stop) {
    case FrictionAxisStop::converged:
      return "converged";
    case FrictionAxisStop::too_few_pairs:
      return "too_few_pairs";
    case FrictionAxisStop::too_few_directions:
      return "too_few_directions";
    case FrictionAxisStop::uncertain:
      return "uncertain";
  }
  return "unknown";
}

FrictionAxisFit fit_friction_axis(const ForceSamples& samples, const Eigen::Vector3d& cone_axis,
                                  const FrictionAxisOptions& options) {
  check(samples, cone_axis, options);
  const Ratios ratios = ratios_of(samples, cone_axis, options);
  FrictionAxisFit fit;
  fit.pairs = static_cast<int>(ratios.weights.size());
  if (fit.pairs < kMinPairs) return fit;
  fit.stop = FrictionAxisStop::too_few_directions;
  // Iteratively reweighted least squares. Columns of the solution: t and S, row by row.
  const Eigen::MatrixX3d design = ratios.weights.matrix().asDiagonal() * ratios.design;
  const Eigen::MatrixX2d observed = ratios.weights.matrix().asDiagonal() * ratios.observed;
  Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> solver;
  solver.setThreshold(kMinPivot);
  if (solver.compute(design).rank() < kUnknowns) return fit;
  // Variance of t in units of that of the errors: the first row of the inverse of R of the QR
  // decomposition.
  const Eigen::Matrix3d factor = solver.matrixR().topRows<kUnknowns>();
  const Eigen::Matrix3d inverse =
      solver.colsPermutation() *
      factor.triangularView<Eigen::Upper>().solve(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  Eigen::Matrix<double, kUnknowns, 2> solution = solver.solve(observed);
  Eigen::ArrayXd errors, shrunk = Eigen::ArrayXd::Ones(fit.pairs);
  for (int i = 0; i < kMaxReweightings; ++i) {
    errors = (observed - design * solution).rowwise().norm();
    const double most = kHuberOfRatios * median(errors) / kMedianLength;
    if (!(most > 0)) break;
    shrunk = (errors > most).select(most / errors, 1.0);
    const Eigen::ArrayXd roots = shrunk.sqrt();
    const Eigen::Matrix<double, kUnknowns, 2> before = solution;
    solution = Eigen::MatrixX3d(roots.matrix().asDiagonal() * design)
                   .colPivHouseholderQr()
                   .solve(Eigen::MatrixX2d(roots.matrix().asDiagonal() * observed));
    if ((solution - before).cwiseAbs().maxCoeff() <= kRatioTolerance) break;
  }
  // Mean derivative of Huber's influence function (asymptotic variance of an M-estimate). For a
  // shrunk error it is `shrunk` across the error and zero along it.
  const double felt = (shrunk < 1.0).select(shrunk / 2, 1.0).mean();
  const double variance =
      (shrunk * errors).square().sum() / (2.0 * (fit.pairs - kUnknowns)) / (felt * felt);
  const Eigen::Vector2d t = solution.row(0);
  // An error perpendicular to t rotates (t, 1) by its ratio to |(t, 1)|, one along t by less.
  const double square = 1 + t.squaredNorm();
  const double error =
      std::sqrt(variance * inverse.row(0).squaredNorm() * (1 / square + 1 / (square * square)));
  fit.error = error;
  fit.axis = rotation_between(Eigen::Vector3d::UnitZ(), cone_axis) *
             Eigen::Vector3d(t.x(), t.y(), 1).normalized();
  fit.stop = error <= kMaxError ? FrictionAxisStop::converged : FrictionAxisStop::uncertain;
  return fit;
}

}  // namespace palpate::haptics
