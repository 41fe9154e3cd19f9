// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/certified_fit.h"

#include <algorithm>
#include <utility>

namespace palpate::haptics {
namespace {

// What the stiffness at zero keeps, and the secant stiffness 2 p / |x|^2 at the places of repairs,
// in units of force / extent, where the data have about 1. Enough for a safe ball around zero that
// spares cells, and for repairs that need not be repeated close by.
constexpr double kLeastStiffness = 0.02;
constexpr double kLeastSecant = 0.02;
constexpr int kMaxRepairs = 30;

}  // namespace

CertifiedFit fit_certified(const FieldObjective& objective, const LocalFitOptions& options,
                           const ReachableVolume& volume) {
  LocalFitOptions certain = options;
  certain.constraints.least_stiffness = kLeastStiffness;
  certain.constraints.least_secant = kLeastSecant;
  CertifiedFit result;
  result.fit = fit_local(objective, certain);
  result.certificate = certify_passivity(result.fit.field, volume);
  while (!is_passive(result.certificate) && result.repairs < kMaxRepairs) {
    // What is certain to be missing can be asked for; what is only not proven cannot.
    if (!(result.certificate.weakest_stiffness < kLeastSecant / 2)) break;
    if (result.certificate.weakest == Eigen::Vector3d::Zero()) break;
    certain.constraints.places.push_back(result.certificate.weakest);
    LocalFit repaired = refit(objective, result.fit.field, certain.constraints);
    ++result.repairs;
    repaired.iterations += result.fit.iterations;
    if (repaired.field.bases.empty()) break;
    if (repaired.stop != FitStop::not_converged) repaired.stop = result.fit.stop;
    result.fit = std::move(repaired);
    result.certificate = certify_passivity(result.fit.field, volume);
  }
  return result;
}

}  // namespace palpate::haptics
