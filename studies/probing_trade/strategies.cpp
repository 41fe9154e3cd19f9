// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "strategies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "palpate/probing/campaign.h"
#include "palpate/probing/probing_program.h"
#include "palpate/probing/quasi_static_arm.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr double kSecondsPerHour = 3600;
constexpr double kThesisResolution = 0.4;  // [N]
constexpr int kThesisDirections = 8;
constexpr double kKnownInside = 0.9;  // of the friction cone

// Keeps the trials of one campaign as its store would.
class Keeper {
 public:
  explicit Keeper(const probing::ContactPlan& plan) : plan_(plan) {}

  void take(const probing::TrialOrder& order, const probing::TrialResult& result) {
    measured_.hours += result.seconds / kSecondsPerHour;
    const std::optional<probing::Sample> sample =
        probing::sample_of(order, result, measured_.hours * kSecondsPerHour);
    if (!sample) return;
    ++measured_.samples;
    measured_.slipped += sample->slipped ? 1 : 0;
    place_[sample->id] = measured_.acquisition.samples.size();
    measured_.acquisition.samples.push_back(*sample);
  }
  void mark_boundary(long long trial) {
    measured_.acquisition.samples[place_.at(trial)].on_friction_boundary = true;
  }
  [[nodiscard]] Measured finish() {
    std::set<long long> probed;
    for (const probing::Sample& sample : measured_.acquisition.samples)
      probed.insert(sample.contact);
    for (const probing::Contact& contact : plan_.contacts) {
      if (probed.contains(contact.id)) measured_.acquisition.contacts.push_back(contact);
    }
    return std::move(measured_);
  }

 private:
  const probing::ContactPlan& plan_;
  Measured measured_;
  std::map<long long, std::size_t> place_;
};

Measured run_campaign(const PreparedObject& object, const probing::ContactPlan& plan,
                      const probing::CampaignOptions& options) {
  const auto arm = probing::make_quasi_static_arm(object.specimen, {.seed = options.seed});
  probing::Campaign campaign(plan, options);
  Keeper keeper(plan);
  while (const std::optional<probing::TrialOrder> order = campaign.next()) {
    const probing::TrialRecord record{*order, probing::run_trial(*arm, *order, options.program)};
    keeper.take(record.order, record.result);
    const probing::TrialVerdict verdict = campaign.take(record);
    if (verdict.on_boundary) keeper.mark_boundary(*verdict.on_boundary);
  }
  Measured measured = keeper.finish();
  measured.stated = campaign.progress().stated.error;
  return measured;
}

// [N] The largest tangential force along a unit vector within a part of the cone.
double known_to_hold(const probing::FrictionCone& cone, const Vector3d& normal_force,
                     const Vector3d& along, double most) {
  constexpr double kStep = 1e-6;  // [N]
  double low = 0, high = most;
  while (high - low > kStep) {
    const double middle = (low + high) / 2;
    const Vector3d force = normal_force + middle * along;
    const double inwards = force.dot(cone.axis);
    const bool holds =
        (force - inwards * cone.axis).norm() <= kKnownInside * cone.coefficient * inwards;
    (holds ? low : high) = middle;
  }
  return low;
}

}  // namespace

Measured measure_thesis(const PreparedObject& object, unsigned seed) {
  probing::ContactPlan plan = object.plan;
  plan.options.directions = kThesisDirections;
  return run_campaign(object, plan,
                      {.strategy = probing::TrialStrategy::bisection,
                       .seed = seed,
                       .resolution = kThesisResolution * plan.options.max_force / 3});
}

Measured measure_static(const PreparedObject& object, unsigned seed) {
  std::vector<ChosenForce> chosen;
  const probing::ContactPlan& plan = object.plan;
  for (std::size_t c = 0; c < plan.contacts.size(); ++c) {
    const probing::FrictionCone cone = object.specimen->friction_cone(plan.contacts[c].position);
    const Eigen::Matrix3d frame = probing::tangent_frame(plan.contacts[c]);
    for (int l = 0; l < static_cast<int>(plan.normal_forces.size()); ++l) {
      const double normal = plan.normal_forces[static_cast<std::size_t>(l)];
      const double most =
          std::sqrt(std::max(std::pow(plan.options.max_force, 2) - normal * normal, 0.0));
      for (int k = 0; k < plan.options.directions; ++k) {
        const double angle = probing::direction_angle(plan.options, l, k);
        const Vector3d along = std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1);
        const Vector3d pressed = normal * frame.col(2);
        chosen.push_back({c, pressed + known_to_hold(cone, pressed, along, most) * along, l});
      }
    }
  }
  return measure_chosen(object, seed, chosen);
}

Measured measure_searching(const PreparedObject& object, unsigned seed) {
  return run_campaign(object, object.plan,
                      {.strategy = probing::TrialStrategy::pooled, .seed = seed});
}

Measured measure_adaptive(const PreparedObject& object, unsigned seed,
                          const AdaptiveLimits& limits) {
  return run_campaign(object, object.plan,
                      {.strategy = probing::TrialStrategy::adaptive,
                       .seed = seed,
                       .max_hours = limits.hours,
                       .max_samples = limits.samples});
}

Measured measure_chosen(const PreparedObject& object, unsigned seed,
                        const std::vector<ChosenForce>& chosen) {
  const auto arm = probing::make_quasi_static_arm(object.specimen, {.seed = seed});
  Keeper keeper(object.plan);
  long long trial = 0;
  for (const ChosenForce& one : chosen) {
    const probing::Contact& contact = object.plan.contacts[one.contact];
    const Vector3d inwards = probing::tangent_frame(contact).col(2);
    const Vector3d pressed = one.force.dot(inwards) * inwards;
    const probing::TrialOrder order{.trial = trial++,
                                    .contact = contact,
                                    .level = one.level,
                                    .direction = 0,
                                    .normal_force = pressed,
                                    .tangential_force = one.force - pressed};
    keeper.take(order, probing::run_trial(*arm, order, {}));
  }
  return keeper.finish();
}

}  // namespace palpate::bench
