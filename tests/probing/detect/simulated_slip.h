// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "palpate/probing/slip_detection.h"

namespace palpate::probing::support {

/// A trial with its truth. The object is an isotropic spring, a share of whose compliance is that
/// of a round contact, and whose surface is curved, so that a tip that slips comes to rest.
struct SimulatedTrial {
  SlipTrial trial;
  double load = 0;       // tangential force relative to the limit
  bool slipped = false;  // the tip slid
};

/// [relative to the displacement at full slip] of a round contact that was dragged with `load`
/// times the limit and released (Mindlin and Deresiewicz 1953).
inline double microslip_left(double load) {
  return 2 * std::pow(1 - load / 2, 2.0 / 3) - std::pow(1 - load, 2.0 / 3) - 1;
}

/// The object under the tip, at one contact.
struct SimulatedSpring {
  double compliance = 1;  // [mm/N]
  double share = 0;       // of it in the contact itself
  double friction = 1;
  double radius = 30;  // [mm] of the surface's curvature
};

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline double log_uniform(std::mt19937_64& random, double low, double high) {
  return std::exp(uniform(random, std::log(low), std::log(high)));
}

inline SimulatedSpring any_spring(std::mt19937_64& random) {
  SimulatedSpring spring;
  spring.compliance = 1 / log_uniform(random, 0.1, 5);
  spring.share = uniform(random, 0, 1);
  spring.friction = uniform(random, 0.3, 1.5);
  spring.radius = log_uniform(random, 10, 100);
  return spring;
}

/// A trial with up to twice the tangential force that friction can hold.
inline SimulatedTrial simulate_trial(const SimulatedSpring& spring, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, 1);
  const auto noise = [&](double deviation) {
    return Eigen::Vector3d{deviation * normal(random), deviation * normal(random),
                           deviation * normal(random)};
  };
  const double compliance = spring.compliance, share = spring.share;
  const double pressing = log_uniform(random, 0.1, 3), limit = spring.friction * pressing;  // [N]
  SimulatedTrial result;
  result.load = uniform(random, 0.1, 2);
  result.slipped = result.load > 1;
  const double force = result.load * limit;
  const double held = std::min(result.load, 1.0);
  const double contact_at_limit = 1.5 * limit * compliance * share;  // [mm] displacement
  const double stays = contact_at_limit * microslip_left(held);
  const double elastic =
      (1 - share) * compliance * force + contact_at_limit * (1 - std::pow(1 - held, 2.0 / 3));
  // The surface turns by distance / radius, which raises the limit by about that times the force.
  const double slid = result.slipped ? (result.load - 1) * spring.friction * spring.radius : 0.0;

  const Eigen::AngleAxisd turn(uniform(random, 0, 3), Eigen::Vector3d(0.3, -0.5, 0.8).normalized());
  const Eigen::Vector3d n = turn * Eigen::Vector3d::UnitZ(), t = turn * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d creep = uniform(random, 0, 0.1) * n;
  SlipTrial& trial = result.trial;
  trial.contact = {12, -7, 702};
  trial.normal_force = pressing * n;
  trial.tangential_force = force * t;
  constexpr double kPosition = 0.02, kForce = 0.004;  // [mm], [N] Table 4.1, compensated
  const auto measured = [&](const Eigen::Vector3d& place) -> Eigen::Vector3d {
    return place + noise(kPosition) + compliance * noise(kForce);
  };
  const Eigen::Vector3d pressed = trial.contact + compliance * pressing * n;
  trial.a = measured(pressed);
  trial.b = measured(pressed + (elastic + slid) * t + creep / 2);
  trial.a_again = measured(pressed + (stays + slid) * t + creep);
  trial.creep = 0.9 * creep;
  return result;
}

inline SimulatedTrial simulate_trial(unsigned seed) {
  std::mt19937_64 random(seed);
  const SimulatedSpring spring = any_spring(random);
  return simulate_trial(spring, random);
}

}  // namespace palpate::probing::support
