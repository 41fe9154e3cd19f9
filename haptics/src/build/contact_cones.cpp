// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/contact_cones.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/core/parallel_for.h"

namespace palpate::haptics {
namespace {

// [rad] A ball in a dent slips at a larger angle than a point with the same friction, because the
// object bulges in front of it: taken as a standard deviation although it always has this sign, for
// each unit of the contact's radius over that of the ball, and the most it becomes. Equilibria of
// soft blocks under balls of 4 and 5 mm differ by 0.03 to 0.07 from a quarter of the ball's radius
// on (docs/probing-validation.md).
constexpr double kTurn = 0.2, kMostTurn = 0.055;
// One-sided 95 % quantile of the normal distribution.
constexpr double kBoundQuantile = 1.645;

// [rad] The error that the ball causes at a contact. The radius of the contact is that of Hertz, at
// the mean depth to which the ball is pressed. It is an upper limit where the whole object yields.
double turn_of_ball(double radius, const probing::Contact& contact,
                    std::span<const probing::Sample> samples) {
  double depth = 0;
  for (const probing::Sample& sample : samples)
    depth += std::max((contact.position - sample.a).dot(contact.normal.normalized()), 0.0);
  depth /= std::max(static_cast<double>(samples.size()), 1.0);
  return std::min(kTurn * std::sqrt(depth / radius), kMostTurn);
}

void add_turn(double turn, FrictionFit& fit) {
  const double angle = std::atan(fit.coefficient), bound = std::atan(fit.lower_bound);
  // Without a coefficient only the bound is known.
  const double below = fit.coefficient > 0
                           ? angle - std::hypot(angle - bound, kBoundQuantile * turn)
                           : bound - kBoundQuantile * turn;
  fit.lower_bound = std::tan(std::max(below, 0.0));
  if (fit.coefficient > 0)
    fit.coefficient_error =
        std::hypot(fit.coefficient_error, turn * (1 + fit.coefficient * fit.coefficient));
}

probing::ConeEstimate cone_estimate(const FrictionFit& cone, const Eigen::Vector3d& pressing) {
  return {.angle = std::atan(cone.coefficient),
          .angle_deviation = cone.coefficient_error / (1 + cone.coefficient * cone.coefficient),
          .coefficient = cone.coefficient,
          .coefficient_error = cone.coefficient_error,
          .axis = cone.axis,
          .axis_error = cone.axis_error,
          .tilt = std::atan2(cone.axis.cross(pressing).norm(), cone.axis.dot(pressing))};
}

std::vector<FrictionFit> fit_cones(const probing::CheckedAcquisition& acquisition,
                                   std::span<const std::size_t> source,
                                   const FrictionOptions& options) {
  std::vector<FrictionFit> alone(source.size());
  const auto fit = [&](std::size_t i, const FrictionOptions& with) {
    const probing::Contact& contact = acquisition.contacts()[source[i]];
    return fit_friction(friction_trials(contact, acquisition.samples_of(source[i])), contact.normal,
                        with);
  };
  parallel_for(source.size(), [&](std::size_t i) { alone[i] = fit(i, options); });
  std::vector<FrictionFit> cones = alone;
  parallel_for(source.size(), [&](std::size_t i) {
    if (!alone[i].uses_prior) return;
    std::vector<probing::ConeEstimate> others;
    for (std::size_t k = 0; k < alone.size(); ++k) {
      if (k == i || alone[k].stop != FrictionStop::converged) continue;
      const Eigen::Vector3d pressing = -acquisition.contacts()[source[k]].normal.normalized();
      others.push_back(cone_estimate(alone[k], pressing));
    }
    FrictionOptions with = options;
    with.prior = probing::pooled_prior(others, options.force_noise);
    cones[i] = fit(i, with);
  });
  return cones;
}

}  // namespace

ContactCones fit_contact_cones(const probing::CheckedAcquisition& acquisition,
                               std::span<const std::size_t> source,
                               const FrictionOptions& options) {
  ContactCones result{.cones = fit_cones(acquisition, source, options)};
  std::vector<LoadedContact> contacts;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const probing::Contact& contact = acquisition.contacts()[source[i]];
    contacts.push_back(
        {friction_trials(contact, acquisition.samples_of(source[i])), result.cones[i]});
  }
  result.load = estimate_friction_load(contacts, options);
  if (result.load) {
    FrictionOptions with = options;
    with.load = result.load->load;
    result.cones = fit_cones(acquisition, source, with);
  }
  // Last, because the prior must not average away what is common to all contacts.
  const std::optional<double> radius = acquisition.records().probe_radius;
  if (!radius || options.steady_error == 0) return result;
  for (std::size_t i = 0; i < source.size(); ++i) {
    add_turn(
        turn_of_ball(*radius, acquisition.contacts()[source[i]], acquisition.samples_of(source[i])),
        result.cones[i]);
  }
  return result;
}

}  // namespace palpate::haptics
