// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/parabola_detector.h"

#include <gtest/gtest.h>

#include <cmath>

#include "not_finite.h"
#include "refusal.h"
#include "simulated_approach.h"

namespace palpate::probing {
namespace {

/// Mean place of detection over undisturbed approaches with a constant force.
double mean_place(double stiffness) {
  constexpr int kRuns = 50;
  double sum = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    support::Approach approach = support::random_approach(stiffness, seed);
    approach.force_gradient = approach.friction = approach.jitter = approach.damping = 0;
    ParabolaDetector detector;
    support::simulate(approach, 1, [&](ApproachSample& sample) {
      sample.force = 0.2;
      return !detector.step(sample);
    });
    EXPECT_TRUE(detector.touched()) << stiffness << " " << seed;
    sum += detector.position();
  }
  return sum / kRuns;
}

TEST(ParabolaDetector, NoticesContactInsideTheObjectTheDeeperTheSofter) {
  // The places that errata.md and the design state for the thesis' rule.
  EXPECT_NEAR(mean_place(0.02), 5.4, 1.5);
  EXPECT_NEAR(mean_place(0.2), 1.6, 0.6);
  EXPECT_NEAR(mean_place(1), 0.9, 0.4);
  EXPECT_NEAR(mean_place(5), 0.5, 0.3);
}

TEST(ParabolaDetector, RaisesNoAlarmOnAParabola) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    support::Approach approach = support::random_approach(0, seed);
    approach.force_gradient = approach.friction = approach.jitter = 0;
    approach.free_path = 6;
    ParabolaDetector detector;
    support::simulate(approach, 1, [&](ApproachSample& sample) {
      sample.force = 0.2;
      return !detector.step(sample) && sample.position < 0;
    });
    EXPECT_FALSE(detector.touched()) << seed;
  }
}

TEST(ParabolaDetector, StopsAtAFault) {
  ParabolaDetector detector;
  detector.step({.time = 0, .position = 0});
  EXPECT_FALSE(detector.step({.time = 0.001, .position = kNaN}));
  EXPECT_EQ(detector.fault(), SignalFault::not_finite);
  ParabolaOptions options;
  options.threshold = 0;
  EXPECT_EQ(refusal([&] { return ParabolaDetector(options); }),
            "ParabolaOptions::threshold is 0; it must be > 0");
}

}  // namespace
}  // namespace palpate::probing
