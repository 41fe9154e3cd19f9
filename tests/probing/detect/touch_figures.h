// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "detect/simulated_approach.h"
#include "palpate/probing/contact_detection.h"
#include "palpate/probing/parabola_detector.h"

namespace palpate::probing::support {

inline constexpr double kPush = 0.2;       // [N]
inline constexpr double kSpeedLimit = 30;  // [mm/s]
inline constexpr double kBeforeIt =
    -0.03;  // [mm] a detection farther from the surface is a false alarm

/// One simulated approach, up to the detection.
struct Touch {
  bool touched = false;
  double place = 0;  // [mm] of the tip at the detection, from the surface
  double force = 0;  // [N] the highest so far
  SignalFault fault = SignalFault::none;
  std::vector<ApproachSample> samples;
};

inline Touch approach_until_touch(const Approach& approach,
                                  double give_up = std::numeric_limits<double>::infinity()) {
  ContactDetector detector;
  Touch touch;
  touch.force = simulate(approach, 2.9, [&](ApproachSample& sample) {
    sample.force = approach_force(detector.speed(), kPush, kSpeedLimit);
    touch.touched = detector.step(sample);
    touch.place = sample.position;
    return !touch.touched && detector.fault() == SignalFault::none && sample.position < give_up;
  });
  touch.fault = detector.fault();
  touch.samples.assign(detector.samples().begin(), detector.samples().end());
  return touch;
}

/// Figures of many approaches to objects of one stiffness.
struct TouchFigures {
  int wrong = 0;  ///< false alarms, missed contacts and estimates that were not possible
  double bias = 0, deviation = 0;  ///< [mm] of the place
  double pull = 0;                 ///< error relative to the stated deviation, RMS
  double force = 0;                ///< [N] 99th percentile of the highest force
};

/// \param errors [mm], \param pulls one for each error, or none; \param forces [N] of all approaches.
inline TouchFigures figures_of(int wrong, const std::vector<double>& errors,
                               const std::vector<double>& pulls, std::vector<double> forces) {
  TouchFigures result{.wrong = wrong};
  const auto count = static_cast<double>(errors.size());
  for (const double error : errors) result.bias += error / count;
  for (const double error : errors)
    result.deviation += (error - result.bias) * (error - result.bias) / count;
  for (const double pull : pulls) result.pull += pull * pull / count;
  result.deviation = std::sqrt(result.deviation);
  result.pull = std::sqrt(result.pull);
  std::sort(forces.begin(), forces.end());
  result.force = forces[forces.size() * 99 / 100];
  return result;
}

inline unsigned approach_seed(double stiffness, int run) {
  return static_cast<unsigned>(run + std::lround(1e5 * stiffness));
}

inline TouchFigures touch_figures(double stiffness, int runs) {
  int wrong = 0;
  std::vector<double> errors, forces, pulls;
  for (int run = 0; run < runs; ++run) {
    const Touch touch =
        approach_until_touch(random_approach(stiffness, approach_seed(stiffness, run)));
    forces.push_back(touch.force);
    std::optional<ContactEstimate> estimate;
    if (touch.touched && touch.place > kBeforeIt) estimate = estimate_contact(touch.samples);
    if (!estimate) {
      ++wrong;
      continue;
    }
    errors.push_back(estimate->position);
    pulls.push_back(estimate->position / estimate->position_deviation);
  }
  return figures_of(wrong, errors, pulls, forces);
}

/// The rule of thesis 4.4.1 on the same objects, pushed with a constant force: `place` is where it
/// notices the contact.
inline TouchFigures touch_figures_of_thesis(double stiffness, int runs) {
  int wrong = 0;
  std::vector<double> places, forces;
  for (int run = 0; run < runs; ++run) {
    ParabolaDetector detector;
    forces.push_back(simulate(random_approach(stiffness, approach_seed(stiffness, run)), 2.9,
                              [&](ApproachSample& sample) {
                                sample.force = kPush;
                                return !detector.step(sample) &&
                                       detector.fault() == SignalFault::none;
                              }));
    if (!detector.touched() || detector.position() <= kBeforeIt) {
      ++wrong;
      continue;
    }
    places.push_back(detector.position());
  }
  return figures_of(wrong, places, {}, forces);
}

}  // namespace palpate::probing::support
