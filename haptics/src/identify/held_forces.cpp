// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/held_forces.h"

#include <cmath>
#include <numbers>

#include "palpate/core/parallel_for.h"

namespace palpate::haptics {
namespace {

// Mean of a standard normal number that is known to be below a limit.
double mean_below(double limit) {
  const double share = std::erfc(-limit / std::numbers::sqrt2) / 2;
  const double density = std::exp(-limit * limit / 2) / std::sqrt(2 * std::numbers::pi);
  // Far outside of the boundary the force was just inside.
  return share > 0 ? -density / share : limit;
}

// [N] The expected error of a force that held.
Eigen::Vector3d expected_error(const FrictionFit& cone, const Eigen::Vector3d& force) {
  const double along = force.dot(cone.axis);
  const Eigen::Vector3d across = force - along * cone.axis;
  const double size = across.norm();
  if (!(size > 0)) return Eigen::Vector3d::Zero();
  const double cosine = 1 / std::hypot(1, cone.coefficient), sine = cone.coefficient * cosine;
  const double distance = cosine * size - sine * along;  // Eq 5.14
  return cone.noise * mean_below(-distance / cone.noise) *
         (cosine / size * across - sine * cone.axis);
}

}  // namespace

std::vector<FrictionFit> friction_cones(const probing::CheckedAcquisition& acquisition,
                                        const IdentifyOptions& options) {
  FrictionOptions friction;
  if (options.force_noise.value_or(0) > 0) friction.force_noise = *options.force_noise;
  std::vector<FrictionFit> cones(acquisition.contacts().size());
  parallel_for(cones.size(), [&](std::size_t c) {
    const probing::Contact& contact = acquisition.contacts()[c];
    const std::vector<FrictionTrial> trials = friction_trials(contact, acquisition.samples_of(c));
    if (!trials.empty()) cones[c] = fit_friction(trials, contact.normal, friction);
  });
  return cones;
}

void expect_held(const std::vector<FrictionFit>& cones, std::vector<Pair>& pairs) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const FrictionFit& cone = cones[pairs[i].contact];
    if (pairs[i].settled != i && cone.stop == FrictionStop::converged)
      pairs[i].held_error = expected_error(cone, pairs[i].force);
  }
}

ParametricLaw with_held_share(const ParametricLaw& law) {
  const Eigen::Index count = law.scale.size();
  const auto with = [&](const Eigen::VectorXd& values, double share) {
    Eigen::VectorXd result(count + 1);
    result << values, share;
    return result;
  };
  ParametricLaw result = law;
  result.names.emplace_back("share of held errors");
  result.units.emplace_back();
  result.scale = with(law.scale, 1);
  result.lower = with(law.lower, 0);
  result.upper = with(law.upper, 1);
  for (Eigen::VectorXd& start : result.starts) start = with(start, 0.5);
  result.predict = [law, count](const Eigen::VectorXd& p, std::span<const Pair> pairs,
                                const Predictions& last) {
    std::vector<Pair> held(pairs.begin(), pairs.end());
    for (Pair& pair : held) pair.force += p[count] * pair.held_error;
    Predictions found = law.predict(p.head(count), held, last);
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].by_parameters.conservativeResize(3, count + 1);
      found[i].by_parameters.col(count) = found[i].compliance * held[i].held_error;
    }
    return found;
  };
  return result;
}

}  // namespace palpate::haptics
