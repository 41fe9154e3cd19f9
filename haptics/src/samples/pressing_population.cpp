// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "samples/pressing_statistics.h"

namespace palpate::haptics {
namespace {

// Rounds of expectation and maximisation; the likelihood hardly changes after some tens.
constexpr int kMaxPopulationRounds = 60;
// They end when the log-likelihood changes by less than this.
constexpr double kLikelihoodTolerance = 0.05;
// Start of the spread of tau, and the range within which a curve is continued to its touch.
constexpr double kFirstTouchSpread = 0.05, kMostTouch = 0.3;
// Standard deviations of the priors: of tau's mean, and of the error of the force relative to the
// root mean square force. They are far wider than what is found.
constexpr double kTouchPrior = 0.1, kBiasPrior = 0.5, kSlopePrior = 1, kMeanPrior = 1e3;
// Steps of the search for the mean of tau and its slope; it follows each kNewtonRounds-th round of
// the variances. A step moves by at most kMostNewtonSteps times its size.
constexpr double kTouchStep = 0.01, kSlopeStep = 0.1, kMostNewtonSteps = 5;
constexpr int kNewtonRounds = 3;
// Start of the noise relative to the force scale, if the samples show none.
constexpr double kFirstNoiseShare = 1e-2;
// Least variances relative to the square of the force scale, and of tau.
constexpr double kLeastShare = 1e-12, kLeastTouchVariance = 1e-10;

using Binomials = std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1>;

constexpr Binomials binomials() {
  Binomials result{};
  for (std::size_t n = 0; n <= kMaxDegree; ++n) {
    result[n][0] = 1;
    for (std::size_t k = 1; k <= n; ++k)
      result[n][k] = result[n - 1][k - 1] + (k < n ? result[n - 1][k] : 0);
  }
  return result;
}
constexpr Binomials kBinomials = binomials();

// Coefficients of the powers of zeta in (zeta + tau)^k, k = 1 ... degree, and their derivatives by
// tau.
struct Shift {
  RowBlock value, derivative;
};

Shift shifted_powers(int degree, double tau) {
  Shift shift;
  shift.value.setZero(degree + 1, degree);
  shift.derivative.setZero(degree + 1, degree);
  for (int k = 1; k <= degree; ++k) {
    for (int m = 0; m <= k; ++m) {
      const double ways = kBinomials[static_cast<std::size_t>(k)][static_cast<std::size_t>(m)];
      shift.value(m, k - 1) = ways * std::pow(tau, k - m);
      if (m < k) shift.derivative(m, k - 1) = ways * (k - m) * std::pow(tau, k - m - 1);
    }
  }
  return shift;
}

// Sums for generalised least squares of the parameters, and the parts of all contacts.
struct Marginal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd vector;
  double fit = 0;  // -2 log likelihood, with the most likely parameters
  std::vector<LinearPress> linear;
  std::vector<Eigen::LLT<RowBlock>> factors;
};

// Squares and number of what is orthogonal to the compressed data.
struct Rest {
  double squares = 0, free = 0, samples = 0;
};

Marginal marginal(std::span<const CompressedPress> presses, const PressingState& state,
                  double force_scale, const BiasInformation& bias, const Rest& rest) {
  Marginal result;
  result.linear.resize(presses.size());
  result.factors.resize(presses.size());
  for (std::size_t i = 0; i < presses.size(); ++i) {
    result.linear[i] = linearized(presses[i], state, state.coefficients[i],
                                  expected_tau(state, presses[i].height));
    const LinearPress& press = result.linear[i];
    RowBlock variance = press.curve * state.covariance * press.curve.transpose() +
                        state.touch_variance * press.touch * press.touch.transpose();
    variance.diagonal().array() += state.noise_variance;
    result.factors[i].compute(variance);
    const Design white = result.factors[i].matrixL().solve(press.design);
    const Rows data = result.factors[i].matrixL().solve(press.force);
    if (i == 0) {
      result.matrix = Eigen::MatrixXd::Zero(white.cols(), white.cols());
      result.vector = Eigen::VectorXd::Zero(white.cols());
    }
    result.matrix += white.transpose() * white;
    result.vector += white.transpose() * data;
    result.fit +=
        data.squaredNorm() + 2 * result.factors[i].matrixLLT().diagonal().array().log().sum();
  }
  result.fit += rest.squares / state.noise_variance + rest.free * std::log(state.noise_variance);
  add_priors(state.variant, force_scale, bias, result.matrix, result.vector);
  result.fit -= result.vector.dot(result.matrix.ldlt().solve(result.vector));
  result.fit += touch_prior(state);
  return result;
}

// One round of expectation and maximisation of the variances, with the coefficients of all
// contacts.
void maximise_variances(std::span<const CompressedPress> presses, const Marginal& sums,
                        double least, bool estimate_noise, const Rest& rest, PressingState& state) {
  const int degree = state.variant.degree;
  const double count = static_cast<double>(presses.size());
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(degree, degree);
  double touches = 0, errors = rest.squares;
  for (std::size_t i = 0; i < presses.size(); ++i) {
    const LinearPress& press = sums.linear[i];
    const Rows residual = press.force - press.design * state.parameters;
    RowBlock all(press.force.size(), degree + 1);
    all << press.curve, press.touch;
    RowBlock gain(degree + 1, press.force.size());
    gain.topRows(degree) = state.covariance * press.curve.transpose();
    gain.row(degree) = state.touch_variance * press.touch.transpose();
    const Rows change = gain * sums.factors[i].solve(residual);
    RowBlock posterior = -gain * sums.factors[i].solve(RowBlock(gain.transpose()));
    posterior.topLeftCorner(degree, degree) += state.covariance;
    posterior(degree, degree) += state.touch_variance;
    state.coefficients[i] = state.parameters.head(degree) + change.head(degree);
    state.touches[i] = expected_tau(state, presses[i].height) + change(degree);
    state.touch_variances[i] = posterior(degree, degree);
    scatter += change.head(degree) * change.head(degree).transpose() +
               posterior.topLeftCorner(degree, degree);
    touches += change(degree) * change(degree) + posterior(degree, degree);
    errors += (residual - all * change).squaredNorm() + (all * posterior * all.transpose()).trace();
  }
  state.covariance = scatter / count;
  state.covariance.diagonal().array() += least;
  if (state.variant.touch) state.touch_variance = std::max(touches / count, kLeastTouchVariance);
  if (estimate_noise) state.noise_variance = std::max(errors / rest.samples, least);
}

}  // namespace

double expected_tau(const PressingState& state, double height) {
  return std::clamp(state.touch + state.height_slope * height, -kMostTouch, kMostTouch);
}

LinearPress linearized(const CompressedPress& press, const PressingState& state,
                       const Rows& coefficients, double tau) {
  const PressingVariant& variant = state.variant;
  const Shift shift = shifted_powers(variant.degree, tau);
  LinearPress linear;
  linear.force = press.force;
  linear.curve = press.powers * shift.value;
  linear.touch = press.powers * (shift.derivative * coefficients);
  if (!variant.touch) linear.touch.setZero();
  const Eigen::Index biases = variant.force ? press.bias.size() : 0;
  linear.design.resize(press.force.size(), variant.degree + biases);
  linear.design.leftCols(variant.degree) = linear.curve;
  if (biases > 0) linear.design.rightCols(biases) = press.constant * press.bias;
  return linear;
}

void add_priors(const PressingVariant& variant, double force_scale, const BiasInformation& bias,
                Eigen::MatrixXd& matrix, Eigen::VectorXd& vector) {
  const auto precision = [](double deviation) { return 1 / (deviation * deviation); };
  const Eigen::Index degree = variant.degree;
  matrix.diagonal().head(degree).array() += precision(kMeanPrior * force_scale);
  if (!variant.force) return;
  const Eigen::Index count = bias.vector.size();
  matrix.block(degree, degree, count, count) += bias.matrix;
  vector.segment(degree, count) += bias.vector;
  matrix.diagonal().tail(count).array() += precision(kBiasPrior * force_scale);
}

double touch_prior(const PressingState& state) {
  const double mean = state.touch / kTouchPrior, slope = state.height_slope / kSlopePrior;
  return mean * mean + slope * slope;
}

double newton_step(const std::function<double(double)>& loss, double step, double& at) {
  const double here = loss(at), up = loss(at + step), down = loss(at - step);
  const double slope = (up - down) / (2 * step), curvature = (up - 2 * here + down) / (step * step);
  const double most = kMostNewtonSteps * step;
  const double move =
      curvature > 0 ? std::clamp(-slope / curvature, -most, most) : (slope > 0 ? -most : most);
  const double there = loss(at + move);
  if (there < std::min({here, up, down}))
    at += move;
  else if (std::min(up, down) < here)
    at += up < down ? step : -step;
  return curvature > 0 ? std::sqrt(2 / curvature) : std::numeric_limits<double>::infinity();
}

PressingState fit_population(std::span<const CompressedPress> presses,
                             const PressingVariant& variant, double force_scale, double noise,
                             const BiasInformation& bias) {
  const std::size_t count = presses.size();
  const int degree = variant.degree;
  const double least = kLeastShare * force_scale * force_scale;
  PressingState state;
  state.variant = variant;
  state.covariance = force_scale * force_scale * Eigen::MatrixXd::Identity(degree, degree);
  state.touch_variance = variant.touch ? kFirstTouchSpread * kFirstTouchSpread : 0;
  state.coefficients.assign(count, Rows::Zero(degree));
  for (Rows& coefficients : state.coefficients) coefficients(0) = force_scale;
  state.touches.assign(count, 0);
  state.touch_variances.assign(count, 0);
  Rest rest;
  for (const CompressedPress& press : presses) {
    rest.squares += press.rest;
    rest.free += press.samples - static_cast<double>(press.force.size());
    rest.samples += press.samples;
  }
  state.noise_variance = noise > 0 ? noise * noise
                         : rest.free > 0
                             ? std::max(rest.squares / rest.free, least)
                             : kFirstNoiseShare * kFirstNoiseShare * force_scale * force_scale;
  double before = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMaxPopulationRounds; ++round) {
    const Marginal sums = marginal(presses, state, force_scale, bias, rest);
    const Eigen::LDLT<Eigen::MatrixXd> solver(sums.matrix);
    state.parameters = solver.solve(sums.vector);
    state.parameter_covariance =
        solver.solve(Eigen::MatrixXd::Identity(sums.matrix.rows(), sums.matrix.cols()));
    state.log_likelihood = -sums.fit / 2;
    maximise_variances(presses, sums, least, !(noise > 0), rest, state);
    const bool converged = std::abs(state.log_likelihood - before) < kLikelihoodTolerance;
    if (converged && round > kNewtonRounds) break;
    before = state.log_likelihood;
    if (!variant.touch || round % kNewtonRounds != kNewtonRounds - 1) continue;
    const auto loss_of = [&](double& value) {
      return [&](double at) {
        const double kept = std::exchange(value, at);
        const double loss = marginal(presses, state, force_scale, bias, rest).fit;
        value = kept;
        return loss;
      };
    };
    const auto step = [&](double& value, double size) {
      double next = value;
      const double error = newton_step(loss_of(value), size, next);
      value = next;
      return error;
    };
    const double error = step(state.touch, kTouchStep);
    state.touch_covariance(0, 0) = error * error;
    if (!variant.height) continue;
    const double slope_error = step(state.height_slope, kSlopeStep);
    state.touch_covariance(1, 1) = slope_error * slope_error;
  }
  return state;
}

double information_criterion(const PressingState& state, std::size_t contacts) {
  const int degree = state.variant.degree;
  double parameters = static_cast<double>(state.parameters.size()) + degree * (degree + 1) / 2.0;
  if (state.variant.touch) parameters += 2;  // its mean and its variance
  if (state.variant.height) parameters += 1;
  return -2 * state.log_likelihood + parameters * std::log(static_cast<double>(contacts));
}

}  // namespace palpate::haptics
