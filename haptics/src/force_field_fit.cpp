// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/force_field_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "field_objective.h"
#include "local_fit.h"
#include "palpate/error.h"

namespace palpate::haptics {
namespace {

// epsilon over the root mean square of the displacements. Measured on two kinds of sheet: 0.5 to 1
// fit best, 0.1 and 4 give twice the error.
constexpr double kEpsilonRatio = 1;
// Cost of weights against the squared error, both in units of the data: far below the noise of any
// arm; settles what the samples leave open.
constexpr double kWeightPenalty = 1e-7;

void check(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
           const Eigen::Ref<const Eigen::Matrix3Xd>& forces, const FitOptions& options) {
  if (displacements.cols() != forces.cols() || forces.cols() == 0) {
    throw InvalidInput("fit_force_field(): " + std::to_string(displacements.cols()) +
                       " displacements and " + std::to_string(forces.cols()) +
                       " forces; there must be as many of both, and at least one");
  }
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    if (!displacements.col(i).allFinite() || !forces.col(i).allFinite()) {
      throw InvalidInput("fit_force_field(): sample " + std::to_string(i) +
                         " is not finite; leave it out");
    }
  }
  if (!(options.accuracy >= 0)) {
    throw InvalidInput("fit_force_field(): accuracy is " + std::to_string(options.accuracy) +
                       " N; it must be >= 0");
  }
  if (options.max_bases < 1) {
    throw InvalidInput("fit_force_field(): max_bases is " + std::to_string(options.max_bases) +
                       "; it must be >= 1");
  }
  if (options.epsilon && (!(*options.epsilon > 0) || !std::isfinite(*options.epsilon))) {
    throw InvalidInput("fit_force_field(): epsilon is " + std::to_string(*options.epsilon) +
                       " mm; it must be finite and > 0");
  }
}

// Root mean square of the columns' lengths, without overflow.
double extent(const Eigen::Ref<const Eigen::Matrix3Xd>& columns) {
  const double largest = columns.cwiseAbs().maxCoeff();
  if (largest == 0) return 0;
  return largest * std::sqrt((columns / largest).colwise().squaredNorm().mean());
}

// Columns in an order that does not depend on how they came: sums round the same way.
std::vector<Eigen::Index> canonical_order(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                          const Eigen::Ref<const Eigen::Matrix3Xd>& forces) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(forces.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto key = [&](Eigen::Index i) {
    return std::array{displacements(0, i), displacements(1, i), displacements(2, i),
                      forces(0, i),        forces(1, i),        forces(2, i)};
  };
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index i, Eigen::Index j) { return key(i) < key(j); });
  return order;
}

double smallest_eigenvalue(const ForceField& field) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
      stiffness(field, Eigen::Vector3d::Zero()), Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[0];
}

}  // namespace

FitResult fit_force_field(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                          const FitOptions& options) {
  check(displacements, forces, options);
  const std::vector<Eigen::Index> order = canonical_order(displacements, forces);
  FieldObjective objective;
  objective.displacements = displacements(Eigen::all, order);
  objective.forces = forces(Eigen::all, order);
  const double length = extent(objective.displacements), force_scale = extent(objective.forces);
  FitResult result;
  if (force_scale == 0 || length == 0) {
    result.stop = force_scale == 0 ? FitStop::accurate : FitStop::not_determined;
    result.rms = force_scale;
    return result;
  }
  objective.displacements /= length;
  objective.forces /= force_scale;
  objective.weight_penalty = kWeightPenalty;
  LocalFitOptions local;
  local.accuracy = options.accuracy / force_scale;
  local.max_bases = options.max_bases;
  local.epsilon = options.epsilon ? *options.epsilon / length : kEpsilonRatio;
  local.constraints.free_epsilon = !options.epsilon;
  LocalFit fit = fit_local(objective, local);
  result.field = std::move(fit.field);
  for (Multiquadric& base : result.field.bases) {
    base.center *= length;
    base.epsilon *= length;
    base.weight *= force_scale;
  }
  result.rms = fit.rms * force_scale;
  result.iterations = fit.iterations;
  result.stop = fit.stop;
  result.smallest_stiffness = smallest_eigenvalue(result.field);
  return result;
}

const char* to_string(FitStop stop) {
  switch (stop) {
    case FitStop::accurate:
      return "accurate";
    case FitStop::max_bases:
      return "max_bases";
    case FitStop::no_gain:
      return "no_gain";
    case FitStop::not_converged:
      return "not_converged";
    case FitStop::not_determined:
      return "not_determined";
  }
  return "unknown";
}

}  // namespace palpate::haptics
