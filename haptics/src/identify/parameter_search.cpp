// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/parameter_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "palpate/core/parallel_for.h"

namespace palpate::haptics {
namespace {

/// Factors of the damping after a step that reduces the cost, and after one that does not.
constexpr double kLess = 0.1, kMore = 10;
constexpr double kLeastDamping = 1e-9;
constexpr double kMostDamping = 1e12;
/// Damping of directions without any effect, relative to the largest diagonal element.
constexpr double kIdle = 1e-12;
/// A search may rest at a low damping only, because a high damping shortens the step.
constexpr double kRestingDamping = 1e-5;
/// It also rests if no parameter moves by more than this times its scale.
constexpr double kRestingStep = 1e-10;

/// Sum of Huber's loss; infinite without predictions.
double cost_of(const Problem& problem, const std::vector<Eigen::Vector3d>& residual) {
  if (residual.empty()) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const Eigen::Vector3d& r : residual) {
    const double s = r.norm();
    sum += s <= problem.huber ? s * s : problem.huber * (2 * s - problem.huber);
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

/// The step in units of the scales; parameters at a bound stay.
Eigen::VectorXd damped_step(const ParametricLaw& law, const Eigen::VectorXd& at,
                            const NormalEquations& normal, double damping) {
  Eigen::MatrixXd matrix = normal.matrix;
  Eigen::VectorXd right = -normal.gradient;
  const double largest = matrix.diagonal().maxCoeff();
  matrix.diagonal() += (damping * normal.matrix.diagonal().array() + kIdle * largest).matrix();
  for (Eigen::Index k = 0; k < right.size(); ++k) {
    if (!held_by_bound(law, at, normal, k)) continue;
    matrix.row(k).setZero();
    matrix.col(k).setZero();
    matrix(k, k) = 1;
    right[k] = 0;
  }
  return matrix.ldlt().solve(right);
}

}  // namespace

decltype(ParametricLaw::predict) each_pair(
    std::function<std::optional<Prediction>(const Eigen::VectorXd&, const Pair&, const Prediction*)>
        predict) {
  return [predict = std::move(predict)](const Eigen::VectorXd& parameters,
                                        std::span<const Pair> pairs, const Predictions& last) {
    Predictions result(pairs.size());
    std::atomic<bool> refused = false;
    parallel_for(pairs.size(), [&](std::size_t i) {
      if (refused) return;
      const auto found = predict(parameters, pairs[i], last.empty() ? nullptr : &last[i]);
      if (found && found->displacement.allFinite() && found->by_parameters.allFinite()) {
        result[i] = *found;
      } else {
        refused = true;
      }
    });
    if (refused) result.clear();
    return result;
  };
}

std::vector<Eigen::Vector3d> residuals(const Problem& problem, const Weights& weights,
                                       const Predictions& predictions) {
  std::vector<Eigen::Vector3d> result(predictions.size());
  const auto error = [&](std::size_t i) -> Eigen::Vector3d {
    return problem.pairs[i].displacement - predictions[i].displacement;
  };
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::size_t settled = problem.pairs[i].settled;
    Eigen::Vector3d r = error(i);
    if (weights.shared_error && settled != i) r -= error(settled);
    result[i] = weights.whiten[i] * r;
  }
  return result;
}

NormalEquations normal_equations(const Problem& problem, const Weights& weights,
                                 const Predictions& predictions) {
  const Eigen::Index count = problem.law.scale.size();
  const std::vector<Eigen::Vector3d> residual = residuals(problem, weights, predictions);
  NormalEquations normal{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)};
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const std::size_t settled = problem.pairs[i].settled;
    decltype(Prediction::by_parameters) rows = -predictions[i].by_parameters;
    if (weights.shared_error && settled != i) rows += predictions[settled].by_parameters;
    rows = weights.whiten[i] * rows * problem.law.scale.asDiagonal();
    const double distance = residual[i].norm();
    const double weight = distance > problem.huber ? problem.huber / distance : 1;
    normal.matrix.noalias() += weight * rows.transpose() * rows;
    normal.gradient.noalias() += weight * rows.transpose() * residual[i];
  }
  return normal;
}

bool held_by_bound(const ParametricLaw& law, const Eigen::VectorXd& parameters,
                   const NormalEquations& normal, Eigen::Index k) {
  return (parameters[k] <= law.lower[k] && normal.gradient[k] >= 0) ||
         (parameters[k] >= law.upper[k] && normal.gradient[k] <= 0);
}

SearchResult search(const Problem& problem, const Weights& weights, const Eigen::VectorXd& start,
                    Predictions predictions, int max_iterations, double damping) {
  const ParametricLaw& law = problem.law;
  SearchResult state{.parameters = start, .predictions = std::move(predictions)};
  state.cost = cost_of(problem, residuals(problem, weights, state.predictions));
  while (std::isfinite(state.cost) && state.iterations < max_iterations && !state.converged) {
    ++state.iterations;
    const NormalEquations normal = normal_equations(problem, weights, state.predictions);
    if (!normal.matrix.allFinite()) break;
    bool accepted = false;
    while (!accepted && !state.converged) {
      const Eigen::VectorXd next =
          (state.parameters +
           damped_step(law, state.parameters, normal, damping).cwiseProduct(law.scale))
              .cwiseMax(law.lower)
              .cwiseMin(law.upper);
      const Eigen::VectorXd step = (next - state.parameters).cwiseQuotient(law.scale);
      state.converged =
          step.cwiseAbs().maxCoeff() <= kRestingStep || damping > kMostDamping ||
          (damping <= kRestingDamping &&
           step.dot(normal.matrix * step) <= law.resting_change * law.resting_change * state.cost);
      Predictions tried = law.predict(next, problem.pairs, state.predictions);
      const double cost = cost_of(problem, residuals(problem, weights, tried));
      accepted = cost < state.cost;
      if (accepted) {
        state.parameters = next;
        state.predictions = std::move(tried);
        state.cost = cost;
      }
      damping = std::max(damping * (accepted ? kLess : kMore), kLeastDamping);
    }
  }
  return state;
}

}  // namespace palpate::haptics
