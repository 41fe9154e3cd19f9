// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "friction/load_estimate.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "friction/bent_trials.h"
#include "friction/slip_likelihood.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

// Normal forces that differ by less than this factor do not determine an exponent.
constexpr double kLeastRatio = 1.5;
constexpr int kExponentBits = 12;  // to which an exponent is searched: 2^-12 of its range
constexpr std::uintmax_t kMostEvaluations = 20;
// Steady errors are searched up to this number of standard deviations.
constexpr double kSteadyRange = 4;
constexpr double kCurvatureStep = 0.02;  // of the exponent, for its standard error

SlipCone cone_of(const FrictionFit& fit) {
  return {.frame = rotation_between(Eigen::Vector3d::UnitZ(), fit.axis),
          .angle = std::atan(fit.coefficient),
          .noise = fit.noise};
}

std::vector<FrictionTrial> shifted(const LoadedContact& contact, double steady) {
  std::vector<FrictionTrial> trials = contact.trials;
  for (FrictionTrial& trial : trials) {
    const Eigen::Vector3d& axis = contact.cone.axis;
    const Eigen::Vector3d drag = trial.force - trial.force.dot(axis) * axis;
    const double size = drag.norm();
    if (size > 0) trial.force -= std::min(steady / size, 1.0) * drag;
  }
  return trials;
}

// Negative log-likelihood of all trials, each contact with its own most likely cone.
double cost(std::span<const LoadedContact> contacts, const FrictionLoad& load, double steady) {
  std::vector<double> parts(contacts.size());
  parallel_for(contacts.size(), [&](std::size_t i) {
    const LoadedContact& contact = contacts[i];
    const std::vector<FrictionTrial> trials =
        bent(steady == 0 ? contact.trials : shifted(contact, steady), contact.cone.axis, load);
    const SlipCone start = cone_of(contact.cone);
    parts[i] = maximise_likelihood(trials, start, FreeParameters::axis_angle, start.noise).cost;
  });
  return std::accumulate(parts.begin(), parts.end(), 0.0);
}

}  // namespace

std::optional<FrictionLoadEstimate> estimate_friction_load(std::span<const LoadedContact> contacts,
                                                           const FrictionOptions& options) {
  std::vector<LoadedContact> used;
  std::vector<double> normals;
  for (const LoadedContact& contact : contacts) {
    if (contact.cone.stop != FrictionStop::converged) continue;
    LoadedContact kept{.trials = {}, .cone = contact.cone};
    for (const FrictionTrial& trial : contact.trials) {
      const double normal = trial.force.dot(contact.cone.axis);
      if (!(normal > 0)) continue;
      kept.trials.push_back(trial);
      normals.push_back(normal);
    }
    used.push_back(std::move(kept));
  }
  if (normals.empty()) return std::nullopt;
  const auto [least, most] = std::ranges::minmax(normals);
  if (!(most >= kLeastRatio * least)) return std::nullopt;
  const double force = median(normals);

  const double constant = cost(used, {}, 0);
  const auto minimum = [](const auto& function, double low, double high) {
    std::uintmax_t evaluations = kMostEvaluations;
    return boost::math::tools::brent_find_minima(function, low, high, kExponentBits, evaluations);
  };
  const auto bent_cost = [&](double exponent) {
    return cost(used, {.exponent = exponent, .force = force}, 0);
  };
  const auto [exponent, best] = minimum(bent_cost, -kLargestLoadExponent, kLargestLoadExponent);
  const double threshold = std::log(static_cast<double>(normals.size())) / 2;
  if (!(constant - best > threshold)) return std::nullopt;
  double steady = constant;
  if (options.steady_error > 0) {
    const auto steady_cost = [&](double error) {
      return cost(used, {}, error) + std::pow(error / options.steady_error, 2) / 2;
    };
    const double range = kSteadyRange * options.steady_error;
    steady = std::min(steady, minimum(steady_cost, -range, range).second);
  }
  if (!(steady - best > threshold)) return std::nullopt;
  const double low = bent_cost(exponent - kCurvatureStep),
               high = bent_cost(exponent + kCurvatureStep);
  const double curvature = (low - 2 * best + high) / (kCurvatureStep * kCurvatureStep);
  // At the end of the range no such law holds.
  if (!(curvature > 0) || std::abs(exponent) > kLargestLoadExponent - kCurvatureStep)
    return std::nullopt;
  return FrictionLoadEstimate{.load = {.exponent = exponent, .force = force},
                              .exponent_error = 1 / std::sqrt(curvature)};
}

}  // namespace palpate::haptics
