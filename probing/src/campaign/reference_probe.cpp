// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/reference_probe.h"

#include <cmath>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

constexpr int kReferencePress = -1;  // the direction of the normal force alone
constexpr int kFewestOfLine = 3;     // two give a line whatever they measured

}  // namespace

TrialOrder reference_order(const ContactPlan& plan, long long number) {
  if (plan.contacts.empty() || plan.normal_forces.empty())
    throw InvalidInput("reference_order: the plan has no contact or no level; plan at least one");
  const Contact& contact = plan.contacts.front();
  const std::size_t level = plan.normal_forces.size() / 2;
  return {.trial = kFirstReferenceTrial + number,
          .contact = contact,
          .level = static_cast<int>(level),
          .direction = kReferencePress,
          .normal_force = -plan.normal_forces[level] * contact.normal.normalized()};
}

ReferenceDrift reference_drift(std::span<const ReferenceProbe> probes, const ContactPlan& plan,
                               const ProgramOptions& options) {
  const TrialOrder order = reference_order(plan, 0);
  const Eigen::Vector3d inward = order.normal_force.normalized();
  std::vector<double> times, displacements;
  for (const ReferenceProbe& probe : probes) {
    if (probe.result.outcome != TrialOutcome::held || !probe.result.a.allFinite()) continue;
    times.push_back(probe.time);
    displacements.push_back((probe.result.a - order.contact.position).dot(inward));
  }
  const auto count = static_cast<Eigen::Index>(times.size());
  ReferenceDrift found{.probes = static_cast<int>(count)};
  if (count == 0) return found;
  const Eigen::Map<const Eigen::ArrayXd> t(times.data(), count), d(displacements.data(), count);
  found.displacement = d.mean();
  const double duration = t.maxCoeff() - t.minCoeff();
  if (count < kFewestOfLine || !(duration > 0)) return found;
  const Eigen::ArrayXd since = t - t.mean();
  const double squares = since.square().sum();
  found.change = (since * d).sum() / squares * duration;
  // A force that errs moves the tip by the compliance along the normal.
  const double compliance = found.displacement / order.normal_force.norm();
  const double noise = std::hypot(options.position_noise, options.force_noise * compliance);
  found.error = noise / std::sqrt(squares) * duration;
  return found;
}

}  // namespace palpate::probing
