// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/convex_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::haptics {
namespace {

// Bounds in units of the data's extent. Below the least epsilon, a base would be a kink between two
// samples. Above the largest epsilon or distance, it acts as a linear spring or a constant force.
constexpr double kMinEpsilon = 0.01;
constexpr double kMaxEpsilon = 30;
constexpr double kMaxDistance = 10;
// Least epsilon of a ridge beyond all samples, relative to its distance d from them. The samples
// see only its tail, the stiffness w epsilon^2 / d^3, which many pairs of w and epsilon share. A
// small epsilon would put a wall where nothing was measured.
constexpr double kLeastRounding = 0.5;
// Prior of epsilon: centre, in the same units, and standard deviation of its logarithm. It is about
// the distribution found in fields where the samples determine epsilon. Between levels of force
// they do not, and a staircase would fit as well.
constexpr double kExpectedEpsilon = 0.5;
constexpr double kEpsilonDeviation = 0.32;
// Degrees of freedom of the prior, which is Student's t up to a constant factor. Its tails are
// long, so a kink that many samples show costs little.
constexpr double kEpsilonTails = 20;
// Limit of the change of log(epsilon) in one step.
constexpr double kMaxLogStep = 1.5;

// Levenberg-Marquardt (Nielsen's update): initial, smallest and largest damping, and a constant
// added to the damping so that a parameter without influence does not move.
constexpr double kFirstDamping = 1e-3;
constexpr double kMinDamping = 1e-12;
constexpr double kMaxDamping = 1e8;
constexpr double kFloor = 1e-6;
// The search ends after a failed step if the expected gain is below this fraction of `worthwhile`.
constexpr double kHopeless = 0.01;
// Relative damping for the removal of a base, so that parameters with little influence do not jump.
constexpr double kRemovalDamping = 1e-3;

// Distance of a ridge beyond zero and all samples; <= 0 if it is between them.
double distance_beyond(const WhitenedProblem& problem, const Multiquadric& base) {
  const Eigen::VectorXd along = problem.displacements().transpose() * base.ridge;
  const double offset = base.ridge.dot(base.center);
  return std::max(offset - std::max(0.0, along.maxCoeff()),
                  std::min(0.0, along.minCoeff()) - offset);
}

// Raises the epsilon of a ridge beyond the samples to its least value and keeps its tail.
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

// Distance of log(epsilon) from the prior's centre, in its standard deviations.
double surprise(const Multiquadric& base) {
  return std::log(base.epsilon / kExpectedEpsilon) / kEpsilonDeviation;
}

double loss_of_surprise(const Multiquadric& base) {
  return kEpsilonTails * std::log1p(surprise(base) * surprise(base) / kEpsilonTails);
}

// The function to be minimised: the loss of the errors plus the negative log prior.
double total_loss(const WhitenedProblem& problem, const ForceField& field,
                  const Eigen::VectorXd& residuals) {
  double sum = problem.loss(residuals);
  for (const Multiquadric& base : field.bases) sum += loss_of_surprise(base);
  return sum;
}

// Gauss-Newton matrix and gradient of half the total loss.
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
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    const Eigen::Index at = 5 * static_cast<Eigen::Index>(k) + 1;
    const double off = surprise(field.bases[k]), weight = 1 / (1 + off * off / kEpsilonTails);
    result.matrix(at, at) += weight / (kEpsilonDeviation * kEpsilonDeviation);
    result.gradient[at] += weight * off / kEpsilonDeviation;
  }
  return result;
}

// Fixes parameters that are at a bound and whose gradient points beyond it.
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

// Diagonal of the matrix, averaged over the components of a rotation or a centre so that the result
// does not depend on the choice of axes.
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

ConvexSolution refine(const WhitenedProblem& problem, const Effort& effort, ForceField& field) {
  Eigen::VectorXd residuals = problem.residuals(field);
  ConvexSolution solution;
  double least = total_loss(problem, field, residuals);
  Quadratic quadratic;
  double lambda = kFirstDamping, growth = 2;
  bool fresh = true;
  while (solution.iterations < effort.iterations && !solution.converged) {
    ++solution.iterations;
    if (fresh) {
      quadratic = expand(problem, field, residuals);
      hold_bounds(field, quadratic);
    }
    Eigen::MatrixXd damped = quadratic.matrix;
    damped.diagonal() += lambda * damping(field, quadratic.matrix);
    const Eigen::LLT<Eigen::MatrixXd> factor(damped);
    const bool solved = factor.info() == Eigen::Success;
    const Eigen::VectorXd step =
        solved ? Eigen::VectorXd(-factor.solve(quadratic.gradient))
               : Eigen::VectorXd(Eigen::VectorXd::Zero(quadratic.gradient.size()));
    const double expected = -(2 * quadratic.gradient.dot(step) + step.dot(quadratic.matrix * step));
    ForceField next = moved(problem, field, step);
    Eigen::VectorXd next_residuals = problem.residuals(next);
    const double loss = total_loss(problem, next, next_residuals);
    fresh = loss < least;  // also false for NaN
    if (fresh) {
      const double gain = least - loss;
      const double ratio = gain / std::max(expected, std::numeric_limits<double>::min());
      lambda = std::max(kMinDamping, lambda * std::max(1.0 / 3, 1 - std::pow(2 * ratio - 1, 3)));
      growth = 2;
      field = std::move(next);
      residuals = std::move(next_residuals);
      least = loss;
      solution.converged = gain < effort.worthwhile;
    } else {
      lambda *= growth;
      growth *= 2;
      const bool hopeless = solved && !(expected > kHopeless * effort.worthwhile);
      solution.converged = lambda > kMaxDamping || hopeless;
    }
  }
  solution.loss = problem.loss(residuals);
  return solution;
}

std::vector<ForceField> without_one(const WhitenedProblem& problem, const ForceField& field,
                                    std::size_t count) {
  const std::size_t bases = field.bases.size();
  Eigen::MatrixXd matrix = expand(problem, field, problem.residuals(field)).matrix;
  matrix.diagonal() += kRemovalDamping * damping(field, matrix);
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  // A matrix that is not finite has no inverse. Then the base with the least weight counts as the
  // least important, and the other parameters stay.
  const bool solved = factor.info() == Eigen::Success;
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  if (solved) factor.solveInPlace(inverse);
  const auto weight_at = [](std::size_t k) { return 5 * static_cast<Eigen::Index>(k); };
  // Removing weight w raises the total loss by w^2 / inverse_ww if all other parameters are
  // adjusted.
  std::vector<std::pair<double, std::size_t>> costs;
  for (std::size_t k = 0; k < bases; ++k) {
    const double weight = field.bases[k].weight;
    costs.emplace_back(weight * weight / inverse(weight_at(k), weight_at(k)) -
                           (solved ? loss_of_surprise(field.bases[k]) : 0),
                       k);
  }
  std::sort(costs.begin(), costs.end());
  costs.resize(std::min(count, bases));

  std::vector<ForceField> result;
  for (const auto& [cost, least] : costs) {
    const Eigen::Index at = weight_at(least);
    const Eigen::VectorXd step = inverse.col(at) * (-field.bases[least].weight / inverse(at, at));
    ForceField followed = moved(problem, field, step), stayed = field;
    for (ForceField* shorter : {&followed, &stayed}) {
      shorter->bases.erase(shorter->bases.begin() + static_cast<std::ptrdiff_t>(least));
    }
    const bool better = total_loss(problem, followed, problem.residuals(followed)) <
                        total_loss(problem, stayed, problem.residuals(stayed));
    result.push_back(better ? std::move(followed) : std::move(stayed));
  }
  return result;
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
  // Eigenvalues below the rounding of the product are not known.
  return std::sqrt(most / std::max(least, most * std::numeric_limits<double>::epsilon()));
}

}  // namespace palpate::haptics
