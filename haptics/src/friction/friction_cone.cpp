// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/friction_cone.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "friction/bent_trials.h"
#include "friction/slip_intervals.h"
#include "friction/slip_likelihood.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/haptics/rotation.h"
#include "palpate/probing/measurable.h"

namespace palpate::haptics {
namespace {

constexpr double kPlateau = 3;     // see least_noise
constexpr int kMinDirections = 4;  // three unknowns and one to check them with
constexpr int kMinLevels = 2;
// [rad] An axis is determined if its standard error is at most this (3 degrees). Otherwise all
// directions lie on one side.
constexpr double kMaxAxisError = 0.05;
// A contact is frictionless only if the upper bound of the coefficient is at most this as well,
// because weak forces leave the coefficient open even if only forces within the noise held.
constexpr double kSlippery = 0.1;
// Without searches a coefficient is determined if its relative error is at most this.
constexpr double kCoarse = 0.1;
// The search starts with only the ends of the intervals, and with the noise at this fraction of
// their median force, which is nearly a least-squares fit of their middles. The noise is then
// divided by kCooling until it is that of the forces.
constexpr double kFirstNoisePart = 0.3;
constexpr double kCooling = 4;
// One-sided 95 % quantile of the normal distribution, for the signed root of twice the logarithm of
// a likelihood ratio.
constexpr double kBoundQuantile = 1.645;
// The same if nothing slipped, so that there is no most likely cone: there, all trials hold with a
// probability of 5 %, sqrt(-2 ln 0.05).
constexpr double kHeldQuantile = 2.448;
constexpr double kFirstAngleStep = 0.1;  // [rad] of the search if nothing slipped
// The axis about which forces are bent is that of the last fit; after two rounds it moves by less
// than 0.1 degrees (an exponent of -0.2, an axis 7 degrees from the normal).
constexpr int kBendingRounds = 2;
constexpr double kBoundTolerance = 1e-5;  // [rad] of the angle of the lower bound

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

template <typename Measure>
double median_of(std::span<const SlipInterval> intervals, Measure measure) {
  std::vector<double> values;
  for (const SlipInterval& interval : intervals) values.push_back(measure(interval));
  return median(values);
}

// The noise below which the likelihood becomes a plateau with steps. n intervals of width w leave a
// gap of about w / n between the ends nearest to the boundary; kPlateau lets several ends count.
double least_noise(std::span<const SlipInterval> intervals, double force_noise) {
  const double width = median_of(intervals, [](const SlipInterval& interval) {
    return (interval.slipped - interval.held).norm();
  });
  return std::max(force_noise, kPlateau * width / static_cast<double>(intervals.size()));
}

double typical_force(std::span<const SlipInterval> intervals) {
  return median_of(intervals, [](const SlipInterval& interval) {
    return (interval.held + interval.slipped).norm() / 2;
  });
}

// Searches with noise that decreases from that of `cone` to `noise`, so that at first trials far
// from the boundary guide the search as well.
SlipOptimum cool(std::span<const FrictionTrial> trials, SlipCone cone, FreeParameters free,
                 double noise) {
  for (; cone.noise > noise; cone.noise /= kCooling) {
    cone = maximise_likelihood(trials, cone, free, noise).cone;
  }
  cone.noise = noise;
  return maximise_likelihood(trials, cone, free, noise);
}

SlipOptimum fit_cone(std::span<const FrictionTrial> trials, std::span<const SlipInterval> intervals,
                     const Eigen::Vector3d& pressing, double noise) {
  SlipCone cone{.frame = rotation_between(Eigen::Vector3d::UnitZ(), pressing)};
  cone.angle = median_of(intervals, [&](const SlipInterval& interval) {
    return angle_between(interval.held + interval.slipped, pressing);
  });
  cone.noise = kFirstNoisePart * typical_force(intervals);
  std::vector<FrictionTrial> ends;
  for (const SlipInterval& interval : intervals) {
    ends.push_back({interval.held, false});
    ends.push_back({interval.slipped, true});
  }
  cone = cool(ends, cone, FreeParameters::axis_angle, noise).cone;
  cone = maximise_likelihood(trials, cone, FreeParameters::axis_angle, noise).cone;
  return maximise_likelihood(trials, cone, FreeParameters::axis_angle_noise, noise);
}

// The smallest angle of a cone, over all axes, whose likelihood is within `quantile` of that of
// `best`, the most likely cone. If necessary, axes are searched with noise that starts at
// `first_noise`.
double least_angle(std::span<const FrictionTrial> trials, const SlipOptimum& best, double quantile,
                   double first_step, double first_noise) {
  SlipCone feasible = best.cone;  // the nearest cone known from which to look for the axis
  const auto root = [&](const SlipOptimum& found) {
    return std::sqrt(2 * std::max(found.cost - best.cost, 0.0));
  };
  const auto excess = [&](double angle) {
    SlipCone cone = feasible;
    cone.angle = angle;
    SlipOptimum found = maximise_likelihood(trials, cone, FreeParameters::axis, cone.noise);
    if (first_noise > best.cone.noise && root(found) > quantile) {
      cone.noise = first_noise;
      const SlipOptimum other = cool(trials, cone, FreeParameters::axis, best.cone.noise);
      if (other.cost < found.cost) found = other;
    }
    if (root(found) <= quantile && angle < feasible.angle) feasible = found.cone;
    return root(found) - quantile;
  };
  const double at_best = excess(best.cone.angle);
  if (at_best >= 0) return best.cone.angle;
  // Decrease the angle in growing steps until the cone is too narrow.
  double high = best.cone.angle, low = high, at_high = at_best, at_low = at_best;
  for (double step = first_step; at_low < 0; step *= 2) {
    if (low <= 0) return 0;
    high = low;
    at_high = at_low;
    low = std::max(0.0, high - step);
    at_low = excess(low);
  }
  std::uintmax_t evaluations = 50;
  return boost::math::tools::toms748_solve(
             excess, low, high, at_low, at_high,
             [](double a, double b) { return b - a < kBoundTolerance; }, evaluations)
      .first;
}

// The same if the trials do not determine a cone.
double least_angle_of_any(std::span<const FrictionTrial> trials, const Eigen::Vector3d& pressing,
                          double noise) {
  double largest = 0;
  bool slipped = false;
  for (const FrictionTrial& trial : trials) {
    largest = std::max(largest, trial.force.norm());
    slipped = slipped || trial.slipped;
  }
  const double first_noise = std::max(noise, kFirstNoisePart * largest);
  SlipOptimum best{.cone = {.frame = rotation_between(Eigen::Vector3d::UnitZ(), pressing),
                            .angle = kRightAngle,
                            .noise = noise}};
  best.cost = slip_cost(trials, best.cone);
  if (slipped) {
    SlipCone start = best.cone;
    start.angle = kRightAngle / 2;
    start.noise = first_noise;
    const SlipOptimum found = cool(trials, start, FreeParameters::axis_angle, noise);
    if (found.cost < best.cost) best = found;
  }
  return least_angle(trials, best, slipped ? kBoundQuantile : kHeldQuantile, kFirstAngleStep,
                     first_noise);
}

void check(std::span<const FrictionTrial> trials, const Eigen::Vector3d& normal,
           const FrictionOptions& options) {
  constexpr double kLargest = probing::kLargestMeasurement;  // squares are taken of all of these
  require("FrictionOptions::force_noise", options.force_noise, above(0).at_most(kLargest), "N");
  require("FrictionOptions::steady_error", options.steady_error, at_least(0).at_most(kLargest),
          "N");
  require("FrictionOptions::load.force", options.load.force, above(0).at_most(kLargest), "N");
  require("FrictionOptions::load.exponent", options.load.exponent,
          at_least(-kLargestLoadExponent).at_most(kLargestLoadExponent));
  if (!(normal.norm() > 0) || !normal.allFinite()) {
    throw InvalidInput("fit_friction(): the normal must be finite and not zero");
  }
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (probing::is_measurable(trials[i].force)) continue;
    throw InvalidInput("fit_friction(): the force of trial " + std::to_string(i) +
                       " is not finite, or beyond 1e12 N; leave it out");
  }
}

// Fills in the results of the most likely cone.
void take(std::span<const FrictionTrial> trials, const SlipOptimum& best, double least_noise,
          FrictionFit& fit) {
  fit.coefficient = std::tan(best.cone.angle);
  fit.axis = best.cone.frame.col(2);
  fit.noise = best.cone.noise;
  // Noise at its lower limit counts as known.
  const int unknowns = best.cone.noise > least_noise ? 4 : 3;
  const Eigen::FullPivLU<Eigen::MatrixXd> information(
      best.information.topLeftCorner(unknowns, unknowns));
  // Without trials near the boundary the information is singular.
  const Eigen::MatrixXd covariance =
      information.isInvertible()
          ? Eigen::MatrixXd(information.inverse())
          : Eigen::MatrixXd::Constant(unknowns, unknowns, std::numeric_limits<double>::infinity());
  const double angle_error = std::sqrt(covariance(2, 2));
  fit.axis_error = std::sqrt(covariance(0, 0) + covariance(1, 1));
  fit.coefficient_error = angle_error * (1 + fit.coefficient * fit.coefficient);
  const double step = std::clamp(kBoundQuantile * angle_error, kBoundTolerance, kFirstAngleStep);
  fit.lower_bound = std::tan(least_angle(trials, best, kBoundQuantile, step, fit.noise));
}

// Fills in the results of the posterior distribution of cones. `fit.axis` is the pressing
// direction.
void take_posterior(std::span<const FrictionTrial> trials, const FrictionOptions& options,
                    FrictionFit& fit) {
  probing::ConePrior prior = options.prior;
  prior.force_noise = options.force_noise;
  probing::ConePosterior posterior(fit.axis, prior);
  std::vector<probing::ConeTrial> all;
  for (const FrictionTrial& trial : trials) all.push_back({trial.force, trial.slipped});
  posterior.add(all);
  const probing::ConeEstimate found = posterior.estimate();
  fit.uses_prior = true;
  fit.coefficient = found.coefficient;
  fit.coefficient_error = found.coefficient_error;
  fit.lower_bound = std::tan(found.least_angle);
  fit.axis = found.axis;
  fit.axis_error = found.axis_error;
}

}  // namespace

const char* to_string(FrictionStop stop) {
  switch (stop) {
    case FrictionStop::converged:
      return "converged";
    case FrictionStop::too_few_directions:
      return "too_few_directions";
    case FrictionStop::too_few_levels:
      return "too_few_levels";
    case FrictionStop::never_slipped:
      return "never_slipped";
    case FrictionStop::frictionless:
      return "frictionless";
    case FrictionStop::not_converged:
      return "not_converged";
  }
  return "unknown";
}

std::vector<FrictionTrial> friction_trials(const probing::Contact& contact,
                                           std::span<const probing::Sample> samples) {
  std::vector<FrictionTrial> trials;
  for (const probing::Sample& sample : samples) {
    if (sample.contact == contact.id) trials.push_back({sample.force, sample.slipped});
  }
  return trials;
}

namespace {

FrictionFit fit_straight(std::span<const FrictionTrial> trials, const Eigen::Vector3d& pressing,
                         const FrictionOptions& options) {
  FrictionFit fit;
  fit.axis = pressing;
  fit.noise = options.force_noise;
  std::vector<FrictionTrial> used;
  for (const FrictionTrial& trial : trials) {
    // A tool that pulls has no contact, so nothing can slip or hold.
    if (trial.force.dot(pressing) > 0) used.push_back(trial);
  }
  const std::vector<SlipInterval> intervals = slip_intervals(used, pressing, options.force_noise);
  fit.vectors = static_cast<int>(intervals.size());
  fit.directions = count_directions(intervals);
  fit.levels = count_levels(intervals);
  // The result if the cone is not determined.
  const auto only_bound = [&](FrictionStop stop) {
    fit.lower_bound = std::tan(least_angle_of_any(used, pressing, fit.noise));
    fit.stop = stop;
    return fit;
  };
  if (std::none_of(used.begin(), used.end(), [](const auto& trial) { return trial.slipped; })) {
    return only_bound(FrictionStop::never_slipped);
  }
  if (!are_searches(used, pressing, options.force_noise)) {
    FrictionFit found = fit;
    take_posterior(used, options, found);
    fit.uses_prior = true;
    if (found.coefficient_error > kCoarse * std::max(found.coefficient, kSlippery))
      return only_bound(FrictionStop::too_few_directions);
    found.stop = FrictionStop::converged;
    return found;
  }
  if (fit.directions < kMinDirections) return only_bound(FrictionStop::too_few_directions);
  const double noise = least_noise(intervals, options.force_noise);
  const SlipOptimum best = fit_cone(used, intervals, pressing, noise);
  if (!best.converged || best.cone.angle >= kRightAngle) {
    return only_bound(FrictionStop::not_converged);
  }
  take(used, best, noise, fit);
  double largest_normal = 0;
  for (const FrictionTrial& trial : used) {
    largest_normal = std::max(largest_normal, trial.force.dot(pressing));
  }
  const double upper_bound = fit.coefficient + kBoundQuantile * fit.coefficient_error;
  if (fit.lower_bound * largest_normal <= options.force_noise && upper_bound <= kSlippery) {
    fit.stop = FrictionStop::frictionless;
  } else if (!(fit.axis_error <= kMaxAxisError)) {
    fit.stop = FrictionStop::too_few_directions;
  } else {
    fit.stop = fit.levels < kMinLevels ? FrictionStop::too_few_levels : FrictionStop::converged;
  }
  if (!(fit.axis_error <= kMaxAxisError)) fit.axis = pressing;
  return fit;
}

// Trials whose tangential forces are smaller by `error`, or 0.
std::vector<FrictionTrial> with_less_drag(std::vector<FrictionTrial> trials,
                                          const Eigen::Vector3d& pressing, double error) {
  for (FrictionTrial& trial : trials) {
    const Eigen::Vector3d drag = trial.force - trial.force.dot(pressing) * pressing;
    const double size = drag.norm();
    if (size > 0) trial.force -= std::min(error / size, 1.0) * drag;
  }
  return trials;
}

// \param less the same fit to tangential forces that are smaller by the steady error.
void add_steady_error(const FrictionFit& less, FrictionFit& fit) {
  if (fit.coefficient == 0 || less.coefficient == 0) {
    // Only the bounds are known, each with 95 % confidence.
    fit.lower_bound -= kBoundQuantile * std::max(fit.lower_bound - less.lower_bound, 0.0);
  } else {
    const double steady = fit.coefficient - less.coefficient;
    const double below = std::hypot(fit.coefficient - fit.lower_bound, kBoundQuantile * steady);
    fit.coefficient_error = std::hypot(fit.coefficient_error, steady);
    fit.lower_bound = fit.coefficient - below;
  }
  fit.lower_bound = std::max(fit.lower_bound, 0.0);
}

}  // namespace

FrictionFit fit_friction(std::span<const FrictionTrial> trials, const Eigen::Vector3d& normal,
                         const FrictionOptions& options) {
  check(trials, normal, options);
  const Eigen::Vector3d pressing = -normal.normalized();
  FrictionFit fit = fit_straight(trials, pressing, options);
  std::vector<FrictionTrial> straight(trials.begin(), trials.end());
  if (options.load.exponent != 0) {
    for (int round = 0; round < kBendingRounds; ++round) {
      straight = bent(trials, fit.axis, options.load);
      fit = fit_straight(straight, pressing, options);
    }
  }
  if (options.steady_error > 0) {
    const FrictionFit less =
        fit_straight(with_less_drag(straight, pressing, options.steady_error), pressing, options);
    add_steady_error(less, fit);
  }
  return fit;
}

std::optional<int> contradicting_trials(const FrictionFit& cone,
                                        std::span<const FrictionTrial> trials,
                                        const FrictionLoad& load) {
  if (cone.stop == FrictionStop::never_slipped || cone.stop == FrictionStop::not_converged ||
      cone.stop == FrictionStop::too_few_directions) {
    return std::nullopt;
  }
  const double cosine = 1 / std::hypot(1, cone.coefficient), sine = cone.coefficient * cosine;
  int count = 0;
  for (const FrictionTrial& trial : bent(trials, cone.axis, load)) {
    const double along = trial.force.dot(cone.axis);
    const double across = (trial.force - along * cone.axis).norm();
    const double distance = cosine * across - sine * along;  // Eq 5.14
    const double outside = trial.slipped ? -distance : distance;
    count += outside > kContradictingDistance * trial.force.norm() ? 1 : 0;
  }
  return count;
}

}  // namespace palpate::haptics
