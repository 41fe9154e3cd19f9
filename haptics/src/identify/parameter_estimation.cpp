// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/parameter_estimation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/held_forces.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

constexpr const char* kDisplacementNoiseField = "IdentifyOptions::displacement_noise";
constexpr const char* kForceNoiseField = "IdentifyOptions::force_noise";

/// Huber's loss is linear beyond this many standard deviations, which 3 % of valid pairs exceed
/// (chi of three numbers).
constexpr int kMostIterations = 100;  // of a search
constexpr double kHuberOfPairs = 3;
/// A pair beyond this many standard deviations is an outlier, as is one valid pair in ten million.
constexpr double kOutlierDistance = 6;
/// If more than this share of a contact's pairs is beyond it, the model is wrong there, and these
/// pairs are not outliers.
constexpr double kOutlierShare = 0.1;
constexpr int kMaxWeightRounds = 12;
/// Approximate number of pairs on which the starts are compared.
constexpr std::size_t kStartPairs = 300;
/// Initial damping of a search from a distant start, and of one continued with other weights.
constexpr double kFar = 1e-2, kNear = 1e-6;
/// A parameter belongs to a direction if its component of the unit vector is larger.
constexpr double kBelongs = 0.1;
/// Size of a zero eigenvalue due to errors of derivatives, relative to the largest eigenvalue.
constexpr double kZeroEigenvalue = 1e-10;
/// Smallest noise relative to the displacements, due to the digits in files.
constexpr double kLeastPairNoise = 1e-6;

struct Noise {
  double displacement = 0, force = 0;
  bool known = false;
};

/// Variances of displacement and force from the scatter of the settled positions, which contains
/// the force noise times the compliance C: scatter = 3 s_d^2 + |C|^2 s_f^2.
Noise estimate_noise(const Problem& problem, const Predictions& predictions, double least) {
  constexpr int kRounds = 5;
  std::vector<Eigen::Vector3d> rows;  // |C|^2, scatter, degrees of freedom
  for (std::size_t i = 0; i < problem.pairs.size(); ++i) {
    const Pair& pair = problem.pairs[i];
    if (pair.settled != i || pair.repeats < 2) continue;
    rows.emplace_back(predictions[i].compliance.squaredNorm(),
                      std::max(pair.scatter, 3 * least * least), pair.repeats - 1);
  }
  if (rows.empty()) return {};
  Eigen::Vector2d variance(0, 0);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const Eigen::Vector3d& row : rows) {
      const Eigen::Vector2d unit(3, row[0]);
      const double expected = round == 0 ? row[1] : std::max(unit.dot(variance), 3 * least * least);
      const double weight = row[2] / (expected * expected);
      matrix += weight * unit * unit.transpose();
      right += weight * unit * row[1];
    }
    variance = matrix.completeOrthogonalDecomposition().solve(right);
    if (variance[1] < 0) variance = Eigen::Vector2d(right[0] / matrix(0, 0), 0);
    if (variance[0] < 0) variance = Eigen::Vector2d(0, right[1] / matrix(1, 1));
  }
  return {std::max(std::sqrt(variance[0]), least), std::sqrt(variance[1]), true};
}

/// Gives all displacements the same weight, in units of `size`.
Weights equal_weights(std::size_t count, double size) {
  return {std::vector<Eigen::Matrix3d>(count, Eigen::Matrix3d::Identity() / size)};
}

Weights noise_weights(const Problem& problem, const Predictions& predictions, const Noise& noise) {
  Weights weights{.whiten = {}, .shared_error = true};
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const Pair& pair = problem.pairs[i];
    const Eigen::Matrix3d& c = predictions[i].compliance;
    const Eigen::Matrix3d covariance =
        (noise.displacement * noise.displacement * Eigen::Matrix3d::Identity() +
         noise.force * noise.force * c * c.transpose()) /
            (pair.settled == i ? pair.repeats : 1) +
        pair.law_error * pair.law_error * Eigen::Matrix3d::Identity();
    weights.whiten.push_back(
        covariance.llt().matrixL().solve(Eigen::Matrix3d(Eigen::Matrix3d::Identity())));
  }
  return weights;
}

/// Agreement of each contact; single outliers are excluded.
void judge(const Problem& problem, const std::vector<Eigen::Vector3d>& residual,
           std::span<const probing::Contact> contacts, const IdentifyOptions& options,
           Identification& report) {
  std::vector<std::vector<double>> distances(contacts.size());
  for (std::size_t i = 0; i < residual.size(); ++i) {
    distances[problem.pairs[i].contact].push_back(residual[i].norm());
  }
  double sum = 0;
  int numbers = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (distances[c].empty()) continue;
    ContactAgreement agreement;
    agreement.contact = contacts[c].id;
    agreement.pairs = static_cast<int>(distances[c].size());
    const auto far = std::count_if(distances[c].begin(), distances[c].end(),
                                   [](double s) { return s > kOutlierDistance; });
    const bool forgive = static_cast<double>(far) <= kOutlierShare * agreement.pairs;
    agreement.outliers = forgive ? static_cast<int>(far) : 0;
    double here = 0;
    for (const double s : distances[c]) here += forgive && s > kOutlierDistance ? 0 : s * s;
    const int count = 3 * (agreement.pairs - agreement.outliers);
    agreement.chi2 = count > 0 ? here / count : 0;
    sum += here;
    numbers += count;
    report.outliers += agreement.outliers;
    report.contacts.push_back(agreement);
  }
  const auto determined = std::count_if(
      report.parameters.begin(), report.parameters.end(),
      [](const auto& parameter) { return parameter.status == ParameterStatus::determined; });
  const int freedom = numbers - static_cast<int>(determined);
  if (freedom <= 0) return;
  report.chi2 = sum / freedom;
  if (*report.chi2 > options.max_chi2) {
    report.verdict = Verdict::does_not_describe;
  } else if (report.explained >= options.min_explained) {
    report.verdict = Verdict::describes;
  } else {
    report.verdict =
        options.displacement_noise ? Verdict::not_testable : Verdict::does_not_describe;
  }
}

/// Covariance of parameters in units of their scales. In a direction that the data do not
/// determine, they are uncertain by their scales.
struct ParameterCovariance {
  std::vector<Eigen::Index> free;  ///< the parameters that it is of: all that no bound holds
  Eigen::MatrixXd matrix;
  std::vector<bool> determined;
};

ParameterCovariance covariance_of(const ParametricLaw& law, const Eigen::VectorXd& at,
                                  const NormalEquations& normal) {
  ParameterCovariance result;
  for (Eigen::Index k = 0; k < at.size(); ++k)
    if (!held_by_bound(law, at, normal, k)) result.free.push_back(k);
  if (result.free.empty()) return result;
  const Eigen::MatrixXd matrix = normal.matrix(result.free, result.free);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  const double zero = kZeroEigenvalue * eigen.eigenvalues().maxCoeff();
  result.matrix.setZero(matrix.rows(), matrix.cols());
  result.determined.assign(result.free.size(), true);
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const Eigen::VectorXd direction = eigen.eigenvectors().col(i);
    const double value = eigen.eigenvalues()[i];
    const bool known = value * kUndetermined * kUndetermined > 1 && value > zero;
    result.matrix += direction * direction.transpose() / (known ? value : std::max(value, 0.0) + 1);
    for (std::size_t k = 0; k < result.free.size() && !known; ++k)
      if (std::abs(direction[static_cast<Eigen::Index>(k)]) > kBelongs)
        result.determined[k] = false;
  }
  return result;
}

/// The covariance that the scatter of the contacts shows, where the pairs of a contact share errors
/// (Liang and Zeger 1986).
Eigen::MatrixXd covariance_by_contacts(const Problem& problem, const Weights& weights,
                                       const Predictions& predictions,
                                       const ParameterCovariance& all) {
  const Eigen::Index count = std::ssize(all.free);
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(count, count);
  double contacts = 0;
  for (std::size_t begin = 0, end = 0; begin < problem.pairs.size(); begin = end) {
    Problem one{.law = problem.law, .pairs = {}, .huber = problem.huber};
    Weights own{.whiten = {}, .shared_error = weights.shared_error};
    Predictions found;
    for (; end < problem.pairs.size() && problem.pairs[end].contact == problem.pairs[begin].contact;
         ++end) {
      one.pairs.push_back(problem.pairs[end]);
      one.pairs.back().settled -= begin;
      own.whiten.push_back(weights.whiten[end]);
      found.push_back(predictions[end]);
    }
    const Eigen::VectorXd gradient = normal_equations(one, own, found).gradient(all.free);
    scatter += gradient * gradient.transpose();
    ++contacts;
  }
  const double small_number = contacts > 1 ? contacts / (contacts - 1) : 1;
  return small_number * all.matrix * scatter * all.matrix;
}

/// Values and standard errors, for a chi^2 of 1.
void describe(const ParametricLaw& law, const Eigen::VectorXd& at, const NormalEquations& normal,
              Identification& report) {
  report.parameters.clear();
  report.correlations.setConstant(at.size(), at.size(), std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    ParameterEstimate& estimate = report.parameters.emplace_back();
    estimate.name = law.names[static_cast<std::size_t>(k)];
    estimate.unit = law.units[static_cast<std::size_t>(k)];
    if (!held_by_bound(law, at, normal, k) ||
        normal.matrix(k, k) * kUndetermined * kUndetermined <= 1)
      continue;
    estimate.status = ParameterStatus::at_bound;
    estimate.value = at[k];
  }
  const ParameterCovariance covariance = covariance_of(law, at, normal);
  for (std::size_t i = 0; i < covariance.free.size(); ++i) {
    if (!covariance.determined[i]) continue;
    const Eigen::Index k = covariance.free[i], row = static_cast<Eigen::Index>(i);
    const double deviation = std::sqrt(covariance.matrix(row, row));
    ParameterEstimate& estimate = report.parameters[static_cast<std::size_t>(k)];
    estimate.status = ParameterStatus::determined;
    estimate.value = at[k];
    estimate.standard_error = deviation * law.scale[k];
    for (std::size_t j = 0; j < covariance.free.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      if (covariance.determined[j])
        report.correlations(k, covariance.free[j]) =
            covariance.matrix(row, column) /
            (deviation * std::sqrt(covariance.matrix(column, column)));
    }
  }
}

/// Makes each standard error at least what the scatter of the contacts shows.
void widen_by_contacts(const Problem& problem, const Weights& weights, const SearchResult& found,
                       Identification& report) {
  const ParameterCovariance covariance = covariance_of(
      problem.law, found.parameters, normal_equations(problem, weights, found.predictions));
  const Eigen::MatrixXd shown =
      covariance_by_contacts(problem, weights, found.predictions, covariance);
  for (std::size_t i = 0; i < covariance.free.size(); ++i) {
    const Eigen::Index k = covariance.free[i], row = static_cast<Eigen::Index>(i);
    std::optional<double>& error = report.parameters[static_cast<std::size_t>(k)].standard_error;
    if (error) error = std::max(*error, std::sqrt(shown(row, row)) * problem.law.scale[k]);
  }
}

/// Finds the best of the starts using some of the pairs.
Eigen::VectorXd best_start(const Problem& problem, double size) {
  if (problem.law.starts.size() == 1) return problem.law.starts.front();
  Problem part{.law = problem.law, .pairs = {}};
  const std::size_t stride = 1 + problem.pairs.size() / kStartPairs;
  for (std::size_t i = 0; i < problem.pairs.size(); i += stride) {
    part.pairs.push_back(problem.pairs[i]);
  }
  const Weights weights = equal_weights(part.pairs.size(), size);
  SearchResult best{.parameters = problem.law.starts.front(), .predictions = {}};
  for (const Eigen::VectorXd& start : problem.law.starts) {
    SearchResult found = search(part, weights, start, part.law.predict(start, part.pairs, {}),
                                kMostIterations, kFar);
    if (found.cost < best.cost) best = std::move(found);
  }
  return best.parameters;
}

double mean_square(std::span<const Pair> pairs, const Predictions& predictions) {
  double sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sum += (pairs[i].displacement - predictions[i].displacement).squaredNorm();
  }
  return sum / static_cast<double>(pairs.size());
}

/// Returns true if every determined parameter moved by a negligible share of its standard error.
bool rests(const ParametricLaw& law, const std::vector<ParameterEstimate>& estimates,
           const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  for (Eigen::Index k = 0; k < before.size(); ++k) {
    const auto& error = estimates[static_cast<std::size_t>(k)].standard_error;
    if (error && std::abs(after[k] - before[k]) > law.resting_error * *error) return false;
  }
  return true;
}

}  // namespace

void check_identify_options(IdentifyOptions options) {
  require_in_range(fields_of(options));
  if (options.displacement_noise.has_value() == options.force_noise.has_value()) return;
  throw InvalidInput(
      {{options.displacement_noise ? kDisplacementNoiseField : kForceNoiseField, true},
       {" is given alone; give both "},
       {kDisplacementNoiseField, true},
       {" [mm] and "},
       {kForceNoiseField, true},
       {" [N], or neither"}});
}

LawEstimate estimate(const ParametricLaw& wanted, std::span<const Pair> pairs,
                     std::span<const probing::Contact> contacts, const IdentifyOptions& options) {
  const ParametricLaw law = with_held_share(wanted);
  const Problem plain{.law = law, .pairs = {pairs.begin(), pairs.end()}};
  Problem robust = plain;
  robust.huber = kHuberOfPairs;
  double size = 0;
  for (const Pair& pair : pairs) size += pair.displacement.squaredNorm();
  size = std::sqrt(size / static_cast<double>(pairs.size()));
  const double least = kLeastPairNoise * size;

  const Eigen::VectorXd start = best_start(plain, size);
  SearchResult found = search(plain, equal_weights(pairs.size(), size), start,
                              law.predict(start, plain.pairs, {}), kMostIterations, kFar);
  LawEstimate result;
  Identification& report = result.report;
  report.pairs = static_cast<int>(pairs.size());
  report.iterations = found.iterations;
  if (found.predictions.empty()) {
    throw SolverError(
        "identify: this parametric model has no equilibrium at some sample, whatever its "
        "parameters; is a force or a position far from all others?");
  }
  Noise noise;
  Weights weights;
  bool settled = false;
  for (int round = 0; round < kMaxWeightRounds && !settled; ++round) {
    noise = options.displacement_noise
                ? Noise{*options.displacement_noise, options.force_noise.value_or(0), true}
                : estimate_noise(robust, found.predictions, least);
    // Without known noise: equal weights, in units of the remaining scatter.
    weights =
        noise.known
            ? noise_weights(robust, found.predictions, noise)
            : equal_weights(pairs.size(),
                            std::max(std::sqrt(mean_square(pairs, found.predictions) / 3), least));
    const Eigen::VectorXd before = found.parameters;
    found = search(robust, weights, before, std::move(found.predictions), kMostIterations, kNear);
    report.iterations += found.iterations;
    describe(law, found.parameters, normal_equations(robust, weights, found.predictions), report);
    settled = found.converged && rests(law, report.parameters, before, found.parameters);
  }
  result.parameters = found.parameters.head(wanted.scale.size());
  report.displacement_noise = noise.displacement;
  report.force_noise = noise.force;
  const double error = mean_square(pairs, found.predictions);
  report.rms = std::sqrt(error);
  report.explained = 1 - error / (size * size);
  judge(robust, residuals(robust, weights, found.predictions), contacts, options, report);
  for (ParameterEstimate& parameter : report.parameters) {
    if (parameter.standard_error && report.chi2) {
      *parameter.standard_error *= std::sqrt(*report.chi2);
    }
  }
  if (law.inexact) widen_by_contacts(robust, weights, found, report);
  report.parameters.pop_back();
  const Eigen::Index wanted_count = wanted.scale.size();
  report.correlations.conservativeResize(wanted_count, wanted_count);
  result.weights = std::move(weights);
  result.predictions = std::move(found.predictions);
  for (Prediction& prediction : result.predictions)
    prediction.by_parameters.conservativeResize(3, wanted_count);
  if (!noise.known) {
    report.chi2.reset();
    report.verdict = Verdict::not_testable;
  }
  if (!settled) report.verdict = Verdict::not_converged;
  return result;
}

}  // namespace palpate::haptics
