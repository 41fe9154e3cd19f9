// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "convex_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::haptics {
namespace {

// Bounds in units of the data's extent. A base that is rounded less than a hundredth of it is a
// kink between samples; one rounded over thirty times as far, or ten times as far away, is a linear
// spring or a constant force there already.
constexpr double kMinEpsilon = 0.01;
constexpr double kMaxEpsilon = 30;
constexpr double kMaxDistance = 10;
// A ridge beyond all samples shows them its tail only, the stiffness w epsilon^2 / d^3 at a
// distance d: many pairs of w and epsilon make the same one, those of small epsilon with a wall
// where nothing was measured. So it is rounded over at least this part of how far beyond them it
// stands.
constexpr double kLeastRounding = 0.5;
// Of the logarithm of epsilon, in one step.
constexpr double kMaxLogStep = 1.5;

// Loss that a step has to gain for more to be worth while: noise moves the loss by some units.
constexpr double kWorthwhile = 0.1;
// Levenberg-Marquardt (Nielsen's update): damping at the start, at least and at most, and what is
// added to the diagonal so that a parameter without influence stays.
constexpr double kFirstDamping = 1e-3;
constexpr double kMinDamping = 1e-12;
constexpr double kMaxDamping = 1e8;
constexpr double kFloor = 1e-6;
// Relative damping where a base is removed: parameters that hardly matter must not jump.
constexpr double kRemovalDamping = 1e-3;

bool is_ridge(const Multiquadric& base) { return base.ridge != Eigen::Vector3d::Zero(); }

// How far a ridge stands beyond zero and the samples; <= 0 between them.
double distance_beyond(const WhitenedProblem& problem, const Multiquadric& base) {
  const Eigen::VectorXd along = problem.displacements().transpose() * base.ridge;
  const double offset = base.ridge.dot(base.center);
  return std::max(offset - std::max(0.0, along.maxCoeff()),
                  std::min(0.0, along.minCoeff()) - offset);
}

// Rounds a ridge beyond the samples, with its tail as it was.
void round_beyond(const WhitenedProblem& problem, Multiquadric& base) {
  const double least = kLeastRounding * distance_beyond(problem, base);
  if (!(base.epsilon < least)) return;
  base.weight *= (base.epsilon / least) * (base.epsilon / least);
  base.epsilon = least;
}

ForceField moved(const WhitenedProblem& problem, ForceField field, const Eigen::VectorXd& step) {
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    Multiquadric& base = field.bases[k];
    const Eigen::Matrix<double, 5, 1> by = step.segment<5>(5 * static_cast<Eigen::Index>(k));
    base.weight = std::max(0.0, base.weight + by[0]);
    base.epsilon = std::clamp(base.epsilon * std::exp(std::clamp(by[1], -kMaxLogStep, kMaxLogStep)),
                              kMinEpsilon, kMaxEpsilon);
    if (is_ridge(base)) {
      const double offset =
          std::clamp(base.ridge.dot(base.center) + by[2], -kMaxDistance, kMaxDistance);
      base.ridge = (base.ridge + tangents(base.ridge) * by.tail<2>()).normalized();
      base.center = offset * base.ridge;
      round_beyond(problem, base);
    } else {
      base.center += by.tail<3>();
      const double distance = base.center.norm();
      if (distance > kMaxDistance) base.center *= kMaxDistance / distance;
    }
  }
  return field;
}

// Gauss-Newton matrix and gradient of half the loss.
struct Quadratic {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
};

Quadratic expand(const WhitenedProblem& problem, const ForceField& field,
                 const Eigen::VectorXd& residuals) {
  Eigen::MatrixXd jacobian = problem.jacobian(field);
  Eigen::VectorXd weighted = residuals;
  const Eigen::VectorXd weights = problem.robust_weights(residuals).cwiseSqrt();
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    jacobian.middleRows<3>(3 * i) *= weights[i];
    weighted.segment<3>(3 * i) *= weights[i];
  }
  Quadratic result;
  result.matrix = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  result.matrix.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
  result.matrix.triangularView<Eigen::StrictlyUpper>() = result.matrix.transpose();
  result.gradient = jacobian.transpose() * weighted;
  return result;
}

// Takes parameters out of the step that stand at a bound and want beyond it.
void hold_bounds(const ForceField& field, Quadratic& quadratic) {
  const auto hold = [&](Eigen::Index j) {
    quadratic.matrix.row(j).setZero();
    quadratic.matrix.col(j).setZero();
    quadratic.matrix(j, j) = 1;
    quadratic.gradient[j] = 0;
  };
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    const Eigen::Index at = 5 * static_cast<Eigen::Index>(k);
    const Multiquadric& base = field.bases[k];
    if (base.weight <= 0 && quadratic.gradient[at] > 0) hold(at);
    const double slope = quadratic.gradient[at + 1];
    if ((base.epsilon <= kMinEpsilon && slope > 0) || (base.epsilon >= kMaxEpsilon && slope < 0)) {
      hold(at + 1);
    }
  }
}

// The diagonal, alike over the components of a turn or of a centre: its choice of axes must not
// matter.
Eigen::VectorXd damping(const ForceField& field, const Eigen::MatrixXd& matrix) {
  Eigen::VectorXd result = matrix.diagonal();
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    const Eigen::Index at = 5 * static_cast<Eigen::Index>(k);
    const Eigen::Index vector = is_ridge(field.bases[k]) ? 2 : 3;
    auto part = result.segment(at + 5 - vector, vector);
    part.setConstant(part.mean());
  }
  return result.array() + kFloor;
}

}  // namespace

ConvexSolution refine(const WhitenedProblem& problem, int max_iterations, ForceField& field) {
  Eigen::VectorXd residuals = problem.residuals(field);
  ConvexSolution solution{problem.loss(residuals), 0, false};
  Quadratic quadratic;
  double lambda = kFirstDamping, growth = 2;
  bool fresh = true;
  while (solution.iterations < max_iterations && !solution.converged) {
    ++solution.iterations;
    if (fresh) {
      quadratic = expand(problem, field, residuals);
      hold_bounds(field, quadratic);
    }
    Eigen::MatrixXd damped = quadratic.matrix;
    damped.diagonal() += lambda * damping(field, quadratic.matrix);
    const Eigen::VectorXd step = -damped.llt().solve(quadratic.gradient);
    const double expected = -(2 * quadratic.gradient.dot(step) + step.dot(quadratic.matrix * step));
    ForceField next = moved(problem, field, step);
    Eigen::VectorXd next_residuals = problem.residuals(next);
    const double loss = problem.loss(next_residuals);
    fresh = loss < solution.loss;  // also false for NaN
    if (fresh) {
      const double gain = solution.loss - loss;
      const double ratio = gain / std::max(expected, std::numeric_limits<double>::min());
      lambda = std::max(kMinDamping, lambda * std::max(1.0 / 3, 1 - std::pow(2 * ratio - 1, 3)));
      growth = 2;
      field = std::move(next);
      residuals = std::move(next_residuals);
      solution.loss = loss;
      solution.converged = gain < kWorthwhile;
    } else {
      lambda *= growth;
      growth *= 2;
      solution.converged = lambda > kMaxDamping || !(expected > kWorthwhile / 100);
    }
  }
  return solution;
}

void remove_least(const WhitenedProblem& problem, ForceField& field) {
  const Eigen::VectorXd residuals = problem.residuals(field);
  Eigen::MatrixXd matrix = expand(problem, field, residuals).matrix;
  matrix.diagonal() += kRemovalDamping * damping(field, matrix);
  const Eigen::MatrixXd inverse =
      matrix.llt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  // The loss rises by w^2 / inverse_ww if weight w goes to zero and all else follows.
  std::size_t least = 0;
  double least_cost = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    const Eigen::Index at = 5 * static_cast<Eigen::Index>(k);
    const double cost = field.bases[k].weight * field.bases[k].weight / inverse(at, at);
    if (cost < least_cost) {
      least_cost = cost;
      least = k;
    }
  }
  const Eigen::Index at = 5 * static_cast<Eigen::Index>(least);
  const Eigen::VectorXd step = inverse.col(at) * (-field.bases[least].weight / inverse(at, at));
  ForceField followed = moved(problem, field, step), stayed = field;
  for (ForceField* shorter : {&followed, &stayed}) {
    shorter->bases.erase(shorter->bases.begin() + static_cast<std::ptrdiff_t>(least));
  }
  const bool better =
      problem.loss(problem.residuals(followed)) < problem.loss(problem.residuals(stayed));
  field = better ? std::move(followed) : std::move(stayed);
}

double condition_number(const WhitenedProblem& problem, const ForceField& field) {
  if (field.bases.empty()) return 1;
  Eigen::MatrixXd jacobian = problem.jacobian(field);
  for (auto column : jacobian.colwise()) {
    const double length = column.norm();
    if (length > 0) column /= length;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(jacobian.transpose() * jacobian,
                                                             Eigen::EigenvaluesOnly);
  const double least = eigen.eigenvalues()[0];
  const double most = eigen.eigenvalues()[eigen.eigenvalues().size() - 1];
  // Below rounding of the product it is not known how bad it is.
  return std::sqrt(most / std::max(least, most * std::numeric_limits<double>::epsilon()));
}

}  // namespace palpate::haptics
