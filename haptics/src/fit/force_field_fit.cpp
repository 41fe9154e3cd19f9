// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/force_field_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fit/convex_fit.h"
#include "fit/field_objective.h"
#include "fit/force_bulge.h"
#include "fit/left_out_pairs.h"
#include "fit/local_fit.h"
#include "fit/unmeasured_directions.h"
#include "fit/whitened_problem.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

// Epsilon relative to the root mean square of the displacements. Measured on two kinds of sheet:
// 0.5 to 1 fit best, while 0.1 and 4 double the error.
constexpr double kEpsilonRatio = 1;
// Penalty of weights relative to the squared error, in units of the data. It is far below the noise
// of any arm and decides only what the samples leave undetermined.
constexpr double kWeightPenalty = 1e-7;
// Multiples of the noise that fits assume if noise does not explain the errors. Features of the
// samples beyond any field, such as effects of the path of the tool, act like noise.
constexpr std::array<double, 3> kNoiseMultiples = {1, 3, 9};
// The spring of a rigid contact reaches this multiple of the measured force.
constexpr double kRigidReserve = 10;

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
  require("FitOptions::accuracy", options.accuracy, at_least(0), "N");
  require("FitOptions::max_bases", options.max_bases, at_least(1));
  require("FitOptions::noise.force", options.noise.force, at_least(0).finite(), "N");
  require("FitOptions::noise.displacement", options.noise.displacement, at_least(0).finite(), "mm");
  if (options.epsilon && options.mode == FitMode::convex) {
    throw InvalidInput(
        "fit_force_field(): epsilon is given, but a convex fit chooses one for each base; leave it "
        "out, or choose the mode certified or local");
  }
  if (options.expected_stiffness && !options.expected_stiffness->allFinite())
    throw InvalidInput("fit_force_field(): the expected stiffness is not finite; leave it out");
  require("FitOptions::epsilon", options.epsilon, above(0).finite(), "mm");
}

// Root mean square of the columns' lengths, without overflow.
double rms_length(const Eigen::Ref<const Eigen::Matrix3Xd>& columns) {
  const double largest = columns.cwiseAbs().maxCoeff();
  if (largest == 0) return 0;
  return largest * std::sqrt((columns / largest).colwise().squaredNorm().mean());
}

// Order of the columns that does not depend on their input order, so that sums round the same way.
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

// Samples in canonical order, in units of their extents. An extent of zero counts as one unit.
struct ScaledSamples {
  WhitenedProblem problem;  // whitened by the samples' own secant stiffness
  SampleNoise noise;
  ReachableVolume reach;   // [mm]
  double length = 1;       // [mm]
  double force_scale = 1;  // [N]
};

ScaledSamples scaled(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                     const Eigen::Ref<const Eigen::Matrix3Xd>& forces, const FitOptions& options) {
  const std::vector<Eigen::Index> order = canonical_order(displacements, forces);
  const auto unit_of = [](double size) { return size > 0 ? size : 1; };
  Eigen::Matrix3Xd d = displacements(Eigen::all, order), f = forces(Eigen::all, order);
  const double length = unit_of(rms_length(d)), force_scale = unit_of(rms_length(f));
  d /= length;
  f /= force_scale;
  const SampleNoise noise{options.noise.displacement.value_or(kDisplacementNoise) / length,
                          std::max(options.noise.force / force_scale, kExact)};
  return {WhitenedProblem(std::move(d), std::move(f), noise), noise,
          reachable_volume(displacements), length, force_scale};
}

ForceField in_units(ForceField field, double length, double force_scale) {
  for (Multiquadric& base : field.bases) {
    base.center *= length;
    base.epsilon *= length;
    base.weight *= force_scale;
  }
  return field;
}

// Compares the errors with those expected from noise at the field's own stiffness, given the number
// of fitted parameters.
void compare_with_noise(const ScaledSamples& samples, const ForceField& field, double parameters,
                        const FitOptions& options, FitResult& result) {
  WhitenedProblem problem = samples.problem;
  problem.whiten(field.bases.empty() ? ForceField{{Multiquadric{}}} : field);
  const Eigen::VectorXd errors = problem.residuals(field);
  const ReducedChi2 chi2 =
      reduced_chi2(errors.reshaped(3, problem.size()).colwise().squaredNorm(), parameters);
  result.chi2 = chi2.value;
  result.outliers = chi2.outliers;
  result.noise_floor = std::sqrt(problem.mean_noise()) * samples.force_scale;
  result.displacement_noise = options.noise.displacement.value_or(kDisplacementNoise);
}

// Completes the result of any kind of fit. The certificate is made for the field in mm and N,
// because its parameters are rounded again by the scaling.
void finish(const ScaledSamples& samples, const FitOptions& options, ForceField field,
            double parameters, FitResult& result) {
  compare_with_noise(samples, field, parameters, options, result);
  const WhitenedProblem& problem = samples.problem;
  double sum = 0;
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    sum += (force(field, problem.displacements().col(i)) - problem.forces().col(i)).squaredNorm();
  }
  result.rms = samples.force_scale * std::sqrt(sum / static_cast<double>(problem.size()));
  result.field = in_units(std::move(field), samples.length, samples.force_scale);
  result.smallest_stiffness = smallest_stiffness(result.field);
  result.certificate = certify_passivity(result.field, samples.reach);
}

void finish(const ScaledSamples& samples, const FitOptions& options, ForceField field,
            FitResult& result) {
  const double parameters = kBaseSize * static_cast<double>(field.bases.size());
  finish(samples, options, std::move(field), parameters, result);
}

FitStop verdict(const FitResult& result, const FitOptions& options) {
  return result.rms <= options.accuracy ? FitStop::accurate
         : result.chi2 <= kMaxChi2      ? FitStop::explained
                                        : FitStop::unexplained;
}

// A spring as stiff as if the displacements just exceeded the noise; in units of the data.
ForceField rigid_field(double displacement_noise) {
  const double stiffness = 1 / (kRigidRatio * std::sqrt(3.0) * displacement_noise);
  return {{{kRigidReserve, kRigidReserve / stiffness}}};
}

LeftOutOptions convex_options(const ScaledSamples& samples, const FitOptions& options,
                              double noise_multiple) {
  return {.noise = {.displacement = noise_multiple * samples.noise.displacement,
                    .force = noise_multiple * samples.noise.force},
          .accuracy = options.accuracy / samples.force_scale,
          .max_bases = options.max_bases.value_or(kMaxConvexBases)};
}

FitResult fit_as_convex(const ScaledSamples& samples, const FitOptions& options,
                        double noise_multiple = 1) {
  const LeftOutOptions with = convex_options(samples, options, noise_multiple);
  FitResult result;
  result.mode = FitMode::convex;
  ConvexFit fit = fit_convex(
      WhitenedProblem(samples.problem.displacements(), samples.problem.forces(), with.noise),
      with.accuracy, with.max_bases);
  finish(samples, options, std::move(fit.field), result);
  result.iterations = fit.iterations;
  result.condition = fit.condition;
  result.stop = verdict(result, options);
  return result;
}

// Fits in the mode `local` or `certified`. The caller must check the certificate of the latter.
FitResult fit_as_local(const ScaledSamples& samples, const FitOptions& options, FitMode mode) {
  FieldObjective objective;
  objective.displacements = samples.problem.displacements();
  objective.forces = samples.problem.forces();
  objective.weight_penalty = kWeightPenalty;
  LocalFitOptions local;
  local.accuracy = std::max(options.accuracy / samples.force_scale, kExact);
  local.max_bases = options.max_bases.value_or(kMaxLocalBases);
  local.epsilon = options.epsilon ? *options.epsilon / samples.length : kEpsilonRatio;
  local.constraints.free_epsilon = !options.epsilon;
  LocalFit fit = mode == FitMode::certified
                     ? fit_certified(objective, local, {samples.reach.radius / samples.length}).fit
                     : fit_local(objective, local);
  FitResult result;
  result.mode = mode;
  result.iterations = fit.iterations;
  result.stop = fit.stop;
  finish(samples, options, std::move(fit.field), result);
  return result;
}

// The squared errors of a field at the samples, whitened by the samples' own secant stiffness, the
// same for all fields, so that no field gains by being stiff.
Eigen::VectorXd squared_errors(const ScaledSamples& samples, const FitResult& fit) {
  const Eigen::VectorXd errors =
      samples.problem.residuals(in_units(fit.field, 1 / samples.length, 1 / samples.force_scale));
  return errors.reshaped(3, samples.problem.size()).colwise().squaredNorm().transpose();
}

// The squared error that a field is expected to have at other pairs, from those at its own.
double expected_square(const ScaledSamples& samples, const FitResult& fit,
                       const Eigen::VectorXd& squares, double most) {
  const double parameters = kBaseSize * static_cast<double>(fit.field.bases.size());
  return expected_growth(parameters, 3 * static_cast<double>(samples.problem.size())) *
         capped_mean(squares, most);
}

// Of convex fields for several multiples of the noise and a certified one, that which predicts
// pairs best. The errors of convex fields are those at pairs that were left out: they may have
// nearly as many parameters as there are numbers. Certified ones have far fewer, and take too long
// to be fitted again and again. So have convex ones with as many bases as are allowed, if these are
// few; they err because bases are missing, not because of noise.
FitResult best_predicting(const ScaledSamples& samples, const FitOptions& options,
                          const FitResult& convex) {
  if (samples.problem.size() < kLeftOutParts) return convex;
  FitResult best;
  double least = std::numeric_limits<double>::infinity(), most = least;
  int iterations = 0;
  const bool lacks_bases = options.max_bases && *options.max_bases <= kMaxLocalBases &&
                           std::ssize(convex.field.bases) >= *options.max_bases;
  if (lacks_bases) {
    const Eigen::VectorXd squares = squared_errors(samples, convex);
    most = kOutlier * typical_variance(squares);
    least = expected_square(samples, convex, squares, most);
    best = convex;
    iterations = convex.iterations;
  }
  for (const double multiple : lacks_bases ? std::span<const double>() : kNoiseMultiples) {
    const Eigen::VectorXd squares =
        left_out_squares(samples.problem, convex_options(samples, options, multiple));
    // Outliers must not decide.
    if (multiple == 1) most = kOutlier * typical_variance(squares);
    FitResult fit = multiple == 1 ? convex : fit_as_convex(samples, options, multiple);
    iterations += fit.iterations;
    const double error = capped_mean(squares, most);
    if (!(error < least) && !best.field.bases.empty()) continue;
    least = error;
    best = std::move(fit);
  }
  FitResult other = fit_as_local(samples, options, FitMode::certified);
  iterations += other.iterations;
  // In unmeasured places the error of the field may be larger by the factor of its bulge.
  const double bulge =
      force_bulge(in_units(other.field, 1 / samples.length, 1 / samples.force_scale),
                  samples.problem.displacements(), samples.problem.forces());
  const double error =
      bulge * bulge * expected_square(samples, other, squared_errors(samples, other), most);
  if (is_passive(other.certificate) && error < least) best = std::move(other);
  best.iterations = iterations;
  return best;
}

FitResult fit_in_mode(const ScaledSamples& samples, const FitOptions& options) {
  if (options.mode == FitMode::local) return fit_as_local(samples, options, FitMode::local);
  if (options.mode == FitMode::certified) {
    FitResult result = fit_as_local(samples, options, FitMode::certified);
    if (is_passive(result.certificate)) return result;
    FitResult convex = fit_as_convex(samples, options);
    convex.iterations += result.iterations;
    return convex;
  }
  FitResult result = fit_as_convex(samples, options);
  const bool compare = result.stop == FitStop::unexplained
                           ? options.try_certified
                           : options.compare_always && result.stop != FitStop::accurate;
  return compare ? best_predicting(samples, options, result) : result;
}

// The expected stiffness takes the place of what was not measured; the figures are those of all
// that was.
FitResult fit_measured(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces,
                       const UnmeasuredDirections& directions, const FitOptions& options) {
  const MeasuredPairs pairs = measured_pairs(displacements, forces, directions);
  const FitResult fit = fit_in_mode(scaled(pairs.displacements, pairs.forces, options), options);
  const double parameters = kBaseSize * static_cast<double>(fit.field.bases.size());
  const ScaledSamples samples = scaled(displacements, forces, options);
  FitResult result;
  result.mode = fit.mode;
  result.unmeasured = directions.count;
  result.iterations = fit.iterations;
  result.condition = fit.condition;
  finish(samples, options,
         in_units(with_expected_stiffness(fit.field, displacements, directions,
                                          options.expected_stiffness),
                  1 / samples.length, 1 / samples.force_scale),
         parameters, result);
  result.stop = verdict(result, options);
  return result;
}

}  // namespace

FitResult fit_force_field(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                          const FitOptions& options) {
  check(displacements, forces, options);
  const ScaledSamples samples = scaled(displacements, forces, options);
  const bool has_forces = !samples.problem.forces().isZero(0);
  const bool moves = !samples.problem.displacements().isZero(0);
  const double noise = options.noise.displacement.value_or(kDisplacementNoise);
  const bool rigid = options.mode == FitMode::convex && noise > 0 &&
                     (moves ? samples.length : 0) <= kRigidRatio * std::sqrt(3.0) * noise;
  if (has_forces && moves && !rigid) {
    if (options.mode != FitMode::convex) return fit_in_mode(samples, options);
    const std::vector<Eigen::Index> order = canonical_order(displacements, forces);
    const Eigen::Matrix3Xd d = displacements(Eigen::all, order), f = forces(Eigen::all, order);
    const UnmeasuredDirections directions = unmeasured_directions(d, f, noise, options.noise.force);
    return directions.count > 0 ? fit_measured(d, f, directions, options)
                                : fit_in_mode(samples, options);
  }

  FitResult result;
  result.mode = options.mode;
  result.displacement_noise = noise;
  if (has_forces) {
    finish(samples, options, rigid ? rigid_field(noise / samples.length) : ForceField{}, result);
    result.stop = rigid ? FitStop::rigid : FitStop::not_determined;
  } else {
    result.certificate = certify_passivity(result.field, samples.reach);
    result.noise_floor = std::sqrt(3.0) * options.noise.force;
    result.stop = FitStop::accurate;
  }
  return result;
}

FitResult assess_force_field(ForceField field,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& forces, int parameters,
                             const FitOptions& options) {
  check(displacements, forces, options);
  check_force_field(field, "assess_force_field(): the field");
  const ScaledSamples samples = scaled(displacements, forces, options);
  FitResult result;
  result.mode = options.mode;
  finish(samples, options, in_units(std::move(field), 1 / samples.length, 1 / samples.force_scale),
         parameters, result);
  result.stop = verdict(result, options);
  return result;
}

const char* to_string(FitMode mode) {
  switch (mode) {
    case FitMode::convex:
      return "convex";
    case FitMode::certified:
      return "certified";
    case FitMode::local:
      return "local";
  }
  return "unknown";
}

const char* to_string(FitStop stop) {
  switch (stop) {
    case FitStop::accurate:
      return "accurate";
    case FitStop::explained:
      return "explained";
    case FitStop::unexplained:
      return "unexplained";
    case FitStop::rigid:
      return "rigid";
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
