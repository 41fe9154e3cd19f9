// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "samples/realigned_pairs.h"

namespace palpate::haptics {

/// Largest number of parameters of a law, so that derivatives need no dynamic memory: those of a
/// solid of 13 regions, and the share of held errors.
inline constexpr int kMaxParameters = 16;

/// Displacement that a law predicts for a force, and its derivative.
struct Prediction {
  Eigen::Vector3d displacement;  ///< [mm]
  Eigen::Matrix3d compliance;    ///< [mm/N] d displacement / d force, symmetric
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxParameters> by_parameters;
};

using Predictions = std::vector<Prediction>;

/// A parametric law to be estimated.
struct ParametricLaw {
  std::vector<std::string> names, units;
  Eigen::VectorXd scale;         ///< size at which a change of the parameter is large; > 0
  Eigen::VectorXd lower, upper;  ///< bounds; may be infinite
  std::vector<Eigen::VectorXd> starts;
  /// Pairs of a contact share errors of the law, so that standard errors are at least those that
  /// the scatter of the contacts shows.
  bool inexact = false;
  /// A search rests once a step changes the residuals by less than this fraction of their size,
  /// which is equally small in the parameters compared to their uncertainty.
  double resting_change = 1e-4;
  /// Weights rest once no parameter changes by more than this times its standard error.
  double resting_error = 0.02;
  /// Predicts the displacements for the forces of all pairs; empty if these parameters give none
  /// for one of them. `last` is empty or holds the predictions for nearby parameters.
  std::function<Predictions(const Eigen::VectorXd& parameters, std::span<const Pair> pairs,
                            const Predictions& last)>
      predict;
};

/// The function `ParametricLaw::predict` of a law that predicts each pair by itself, or nothing if
/// the parameters give none. `last` is the prediction for nearby parameters, or null. It is called
/// from several threads.
[[nodiscard]] decltype(ParametricLaw::predict) each_pair(
    std::function<std::optional<Prediction>(const Eigen::VectorXd& parameters, const Pair& pair,
                                            const Prediction* last)>
        predict);

/// The residual of pair i is whiten_i r_i, r = displacement - prediction; with `shared_error` it is
/// whiten_i (r_i - r_settled) except for the settled pair itself.
struct Weights {
  std::vector<Eigen::Matrix3d> whiten;
  bool shared_error = false;
};

struct Problem {
  const ParametricLaw& law;
  std::vector<Pair> pairs;
  double huber = std::numeric_limits<double>::infinity();  ///< threshold of Huber's loss
};

[[nodiscard]] std::vector<Eigen::Vector3d> residuals(const Problem& problem, const Weights& weights,
                                                     const Predictions& predictions);

/// J^T W J and J^T W r with Huber's weights W, in units of the parameters' scales.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
};
[[nodiscard]] NormalEquations normal_equations(const Problem& problem, const Weights& weights,
                                               const Predictions& predictions);

/// Returns true if parameter k is at a bound and the sum of losses falls beyond it.
[[nodiscard]] bool held_by_bound(const ParametricLaw& law, const Eigen::VectorXd& parameters,
                                 const NormalEquations& normal, Eigen::Index k);

struct SearchResult {
  Eigen::VectorXd parameters;
  Predictions predictions;  ///< for `parameters`; empty if the law has none at the start
  double cost = std::numeric_limits<double>::infinity();  ///< sum of Huber's losses
  int iterations = 0;
  bool converged = false;
};

/// Levenberg-Marquardt with bounds, from `start` with the given predictions. `damping` is the
/// initial damping: small close to a solution.
[[nodiscard]] SearchResult search(const Problem& problem, const Weights& weights,
                                  const Eigen::VectorXd& start, Predictions predictions,
                                  int max_iterations, double damping);

}  // namespace palpate::haptics
