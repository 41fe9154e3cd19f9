// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "campaign/tangential_force.h"

#include <algorithm>
#include <cmath>

namespace palpate::probing {
namespace {

constexpr double kHoldingDeviations = 1.645;  // normal quantile for the probability `kHolding`
constexpr double kForceStep = 5e-5;           // of a chosen force, relative to the largest

// [N] The largest force from zero to `most` at which a condition holds that no larger force meets.
template <typename Condition>
double largest_force(double most, const Condition& holds) {
  if (holds(most)) return most;
  double low = 0, high = most;
  while (high - low > kForceStep * most) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

double force_for(const AdaptiveSite& site, const AdaptiveSetting& setting, double normal,
                 const Eigen::Vector3d& along, double probability) {
  const Eigen::Vector3d pressed = normal * site.pressing();
  return largest_force(setting.most_tangential(normal), [&](double size) {
    return site.posterior->slip_probability(pressed + size * along) < probability;
  });
}

double surely_held(const AdaptiveSite& site, const AdaptiveSetting& setting, double normal,
                   const Eigen::Vector3d& along) {
  const double coefficient =
      std::tan(std::max(site.cone.angle - kHoldingDeviations * site.cone.angle_deviation, 0.0));
  return largest_force(setting.most_tangential(normal), [&](double size) {
    const Eigen::Vector3d force = normal * site.pressing() + size * along;
    const double inwards = force.dot(site.cone.axis);
    return (force - inwards * site.cone.axis).norm() <= coefficient * inwards;
  });
}

}  // namespace palpate::probing
