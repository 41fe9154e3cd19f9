// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "palpate/probing/approach_signal.h"

namespace palpate::probing::support {

/// A tip that is pushed towards an object, with the values that a detector may not know.
struct Approach {
  double mass = 0.08;          ///< [kg]
  double stiffness = 1;        ///< [N/mm] of the object; 0 for none
  double damping = 0.1;        ///< of the object, relative to critical
  double free_path = 3;        ///< [mm]
  double force_error = 0;      ///< [N] along the approach
  double force_gradient = 0;   ///< [N/mm] of the error along the way
  double friction = 0;         ///< [N] of the joints after the first hundredth of a millimetre
  double quantum = 0.03;       ///< [mm]
  double quantum_phase = 0.4;  ///< place of the surface between two steps of the encoder
  double jitter = 0;           ///< [s] uniform, of the times at which positions are read
  unsigned seed = 1;
};

/// An approach drawn at random, as arms and objects differ; the surface is at position 0.
inline Approach random_approach(double stiffness, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Approach approach;
  approach.mass = 0.08 * uniform(0.85, 1.15);
  approach.stiffness = stiffness;
  approach.damping = uniform(0.02, 0.3);
  approach.free_path = uniform(1.5, 5.5);
  approach.force_error = uniform(-0.02, 0.02);
  approach.force_gradient = uniform(-0.02, 0.02) / 30;
  approach.friction = uniform(0, 0.02);
  approach.quantum_phase = uniform(0, 1);
  approach.jitter = 2e-5;
  approach.seed = seed;
  return approach;
}

/// Simulates at 10 kHz and gives each millisecond a sample to `step`, until it returns false or
/// `duration` is over. \param step (sample) -> whether to go on; it sets the force of the sample.
/// \return [N] the highest force on the object.
inline double simulate(const Approach& approach, double duration,
                       const std::function<bool(ApproachSample&)>& step) {
  constexpr double kStep = 1e-4, kPresliding = 0.01;
  std::mt19937_64 random(approach.seed + 77);
  std::uniform_real_distribution<double> jitter(-1, 1);
  double position = -approach.free_path, speed = 0, force = 0, highest = 0;
  const double per_newton = 1000 / approach.mass;
  const double damping =
      2 * approach.damping * std::sqrt(approach.stiffness / per_newton);  // [N s/mm]
  const int ticks = static_cast<int>(duration / 1e-3);
  for (int tick = 0; tick < ticks; ++tick) {
    ApproachSample sample;
    const double late = approach.jitter * jitter(random);
    sample.time = tick * 1e-3;
    sample.position =
        approach.quantum *
        (std::round((position + late * speed) / approach.quantum - approach.quantum_phase) +
         approach.quantum_phase);
    if (!step(sample)) return highest;
    force = sample.force;
    for (int i = 0; i < 10; ++i) {
      const double reaction =
          position > 0 ? std::max(approach.stiffness * position + damping * speed, 0.0) : 0.0;
      highest = std::max(highest, reaction);
      const double travelled = position + approach.free_path;
      const double friction =
          approach.friction * std::tanh(travelled / kPresliding) * (speed >= 0 ? 1 : -1);
      const double total =
          force + approach.force_error + approach.force_gradient * travelled - friction - reaction;
      speed += kStep * per_newton * total;
      position += kStep * speed;
    }
  }
  return highest;
}

}  // namespace palpate::probing::support
