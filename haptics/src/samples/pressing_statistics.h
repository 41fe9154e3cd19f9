// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "palpate/haptics/pressing_estimate.h"

namespace palpate::haptics {

// Depths are in units of one length Z in this file: zeta = z / Z, tau = t / Z.

/// Largest degree of a curve. A cubic fits what labs record; a fourth power serves clean data.
inline constexpr int kMaxDegree = 4;
/// Rows of a contact's compressed data, and columns of the acquisition's parameters.
inline constexpr int kMaxRows = kMaxDegree + 2, kMaxColumns = kMaxDegree + 5;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
using RowBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;
using Design = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxColumns>;

/// The normal forces of a contact, rotated into the few directions that a polynomial with a
/// constant can reach (QR); the part orthogonal to them shows only the noise.
struct CompressedPress {
  RowBlock powers;  ///< r x (degree + 1): what the powers 0 ... degree of zeta give
  Rows constant;    ///< r: what a constant force gives
  Rows force;       ///< r [N]
  double rest = 0;  ///< [N^2] sum of squares orthogonal to those
  int samples = 0;
  double height = 0;        ///< in units of Z
  Eigen::RowVectorXd bias;  ///< how the parameters of the force's error enter the normal force
};

/// The assumptions about an acquisition.
struct PressingVariant {
  int degree = 1;
  bool force = false, touch = false, height = false;  ///< the offsets that it has
};

/// Information on the force's error from the forces across the pressing: x^T matrix x - 2 vector^T
/// x is -2 log likelihood.
struct BiasInformation {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd vector;
};

/// State of the estimate. `parameters`: mean coefficients [N], then the error of the force [N] if
/// the variant has one.
struct PressingState {
  PressingVariant variant;
  Eigen::MatrixXd covariance;            ///< degree x degree, of the coefficients over the object
  double noise_variance = 0;             ///< [N^2]
  double touch = 0, touch_variance = 0;  ///< of tau: mean, and variance beside that
  double height_slope = 0;               ///< of tau
  Eigen::Matrix2d touch_covariance = Eigen::Matrix2d::Zero();  ///< of the mean and the slope
  Eigen::VectorXd parameters;
  Eigen::MatrixXd parameter_covariance;
  double log_likelihood = 0;
  std::vector<Rows> coefficients;  ///< of each contact, posterior mean
  std::vector<double> touches;     ///< tau of each contact, posterior mean
  std::vector<double> touch_variances;
};

/// tau of a contact before its forces are known.
[[nodiscard]] double expected_tau(const PressingState& state, double height);

/// A contact's part of the model at a given tau, linear in coefficients and in the change of tau.
/// The mean of the data is exactly linear in the coefficients, so that their errors do not pass
/// for offsets.
struct LinearPress {
  RowBlock curve;  ///< r x degree: of its coefficients
  Rows touch;      ///< r: of a change of tau, at the contact's current coefficients
  Design design;   ///< r x columns: of the parameters
  Rows force;      ///< r [N]
};
[[nodiscard]] LinearPress linearized(const CompressedPress& press, const PressingState& state,
                                     const Rows& coefficients, double tau);

/// Weak priors of the parameters, so that what the data leave open stays at zero; and the
/// information `bias`.
void add_priors(const PressingVariant& variant, double force_scale, const BiasInformation& bias,
                Eigen::MatrixXd& matrix, Eigen::VectorXd& vector);

/// The same of the mean of tau and its slope: its part of -2 log likelihood.
[[nodiscard]] double touch_prior(const PressingState& state);

/// Moves `at` towards the minimum of a loss, -2 log likelihood, by one safeguarded Newton step with
/// differences of `step`. Returns the standard error that the curvature gives.
double newton_step(const std::function<double(double)>& loss, double step, double& at);

/// Maximum likelihood of the variances and parameters by expectation and maximisation, as if
/// contacts were independent draws. `noise`: [N] if given, otherwise 0.
[[nodiscard]] PressingState fit_population(std::span<const CompressedPress> presses,
                                           const PressingVariant& variant, double force_scale,
                                           double noise, const BiasInformation& bias);
/// Bayesian information criterion of that.
[[nodiscard]] double information_criterion(const PressingState& state, std::size_t contacts);

/// Learns how coefficients are correlated along the surface, then updates the state: parameters by
/// generalised least squares, coefficients and touches from the contacts around. `estimate_noise`:
/// also the noise, if no contact has more samples than coefficients and there are tens of contacts.
/// Returns the length scale [mm], or 0 if nothing varies.
double fit_neighbourhood(std::span<const CompressedPress> presses,
                         std::span<const PressedContact> contacts, double force_scale,
                         const BiasInformation& bias, bool estimate_noise, PressingState& state);

}  // namespace palpate::haptics
