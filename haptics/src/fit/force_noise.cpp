// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/force_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "fit/field_objective.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"

namespace palpate::haptics {
namespace {

// Least noise, relative to the largest force of a contact. On sheets whose repeated forces scatter
// by 0.1 %, fields that assume so little take half as many bases again and predict left-out
// contacts worse (RMS 0.20 instead of 0.18 N).
constexpr double kLeastNoise = 0.004;
// Contacts that are fitted for the estimate.
constexpr std::size_t kPilots = 5;
// The estimate is the least noise times 2^(k / kSteps), with k up to kMostSteps: up to 64 times.
constexpr int kSteps = 4, kMostSteps = 24;

// The median over contacts of their largest force.
double typical_force(const std::vector<ForceSamples>& contacts) {
  std::vector<double> largest;
  for (const ForceSamples& contact : contacts)
    largest.push_back(contact.forces.colwise().norm().maxCoeff());
  return median(largest);
}

double multiple(int k) { return std::exp2(static_cast<double>(k) / kSteps); }

// The least multiple of the noise with which the errors of a field are no more than noise.
double needed_noise(const ForceSamples& pairs, const FitResult& fit, FitOptions options) {
  const int parameters = static_cast<int>(kBaseSize * fit.field.bases.size());
  const double given = options.noise.force;
  for (int k = 0; k < kMostSteps; ++k) {
    options.noise.force = multiple(k) * given;
    const FitResult assessed = assess_force_field(fit.field, pairs.displacements, pairs.forces,
                                                  std::max(parameters, 1), options);
    if (assessed.chi2 <= 1) return options.noise.force;
  }
  return multiple(kMostSteps) * given;
}

}  // namespace

double estimated_force_noise(const std::vector<ForceSamples>& contacts, double repeated,
                             FitOptions options) {
  const double least = std::max(repeated, kLeastNoise * typical_force(contacts));
  if (options.mode != FitMode::convex || options.compare_always || options.accuracy > 0 ||
      options.max_bases || !(least > 0))
    return least;
  options.noise.force = least;
  options.try_certified = false;
  std::vector<std::size_t> pilots;
  const std::size_t stride = (contacts.size() + kPilots - 1) / kPilots;
  for (std::size_t i = 0; i < contacts.size(); i += stride) {
    const auto numbers = static_cast<double>(3 * contacts[i].forces.cols());
    if (numbers >= 2 * kBaseSize) pilots.push_back(i);
  }
  if (pilots.empty()) return least;
  std::vector<double> needed(pilots.size());
  parallel_for(pilots.size(), [&](std::size_t p) {
    const ForceSamples& pairs = contacts[pilots[p]];
    const FitResult fit = fit_force_field(pairs.displacements, pairs.forces, options);
    needed[p] = fit.stop == FitStop::unexplained ? needed_noise(pairs, fit, options) : least;
  });
  return median(needed);
}

}  // namespace palpate::haptics
