// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/contact_cones.h"

#include <cmath>
#include <utility>

#include "palpate/parallel_for.h"

namespace palpate::haptics {
namespace {

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
  if (!result.load) return result;
  FrictionOptions with = options;
  with.load = result.load->load;
  result.cones = fit_cones(acquisition, source, with);
  return result;
}

}  // namespace palpate::haptics
