// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/force_noise.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "fit/field_objective.h"
#include "palpate/geometry/median.h"
#include "palpate/parallel_for.h"

namespace palpate::haptics {
namespace {

// Contacts that are fitted for the estimate.
constexpr std::size_t kPilots = 5;
// The estimate is the given noise times 2^(k / kSteps), with k up to kMostSteps: 0.01 N to 0.6 N.
constexpr int kSteps = 4, kMostSteps = 24;

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

double estimated_force_noise(const std::vector<ForceSamples>& contacts, const FitOptions& options) {
  const double given = options.noise.force;
  if (options.mode != FitMode::convex || options.compare_always || options.accuracy > 0 ||
      options.max_bases || !(given > 0))
    return given;
  std::vector<std::size_t> pilots;
  const std::size_t stride = (contacts.size() + kPilots - 1) / kPilots;
  for (std::size_t i = 0; i < contacts.size(); i += stride) {
    const auto numbers = static_cast<double>(3 * contacts[i].forces.cols());
    if (numbers >= 2 * kBaseSize) pilots.push_back(i);
  }
  if (pilots.empty()) return given;
  FitOptions with = options;
  with.try_certified = false;
  std::vector<double> needed(pilots.size());
  parallel_for(pilots.size(), [&](std::size_t p) {
    const ForceSamples& pairs = contacts[pilots[p]];
    const FitResult fit = fit_force_field(pairs.displacements, pairs.forces, with);
    needed[p] = fit.stop == FitStop::unexplained ? needed_noise(pairs, fit, with) : given;
  });
  return geometry::median(std::move(needed));
}

}  // namespace palpate::haptics
