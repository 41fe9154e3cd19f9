// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_detection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "not_finite.h"
#include "refusal.h"
#include "simulated_approach.h"
#include "touch_figures.h"

namespace palpate::probing {
namespace {

using support::approach_until_touch;
using support::kBeforeIt;
using support::kPush;
using support::kSpeedLimit;
using support::Touch;

TEST(ContactDetection, FindsTheSurfaceOfSoftAndStiffObjectsAndTouchesThemGently) {
  for (const double stiffness : {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0}) {
    const support::TouchFigures f = support::touch_figures(stiffness, 120);
    EXPECT_EQ(f.wrong, 0) << stiffness;
    EXPECT_LT(std::abs(f.bias), 0.1) << stiffness;
    EXPECT_LT(f.deviation, stiffness < 0.1 ? 0.4 : 0.15) << stiffness;
    EXPECT_LT(f.force, stiffness > 1 ? 1.0 : 0.5) << stiffness;
    EXPECT_GT(f.pull, 0.5) << stiffness;
    EXPECT_LT(f.pull, 2.5) << stiffness;
  }
}

TEST(ContactDetection, RaisesNoAlarmInFreeSpace) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    support::Approach approach = support::random_approach(0, seed);
    approach.free_path = 6;
    const Touch touch = approach_until_touch(approach, 2);
    EXPECT_FALSE(touch.touched) << seed << " at " << touch.place;
    EXPECT_EQ(touch.fault, SignalFault::none) << seed;
  }
}

TEST(ContactDetection, NeedsNoBraking) {
  for (const double stiffness : {0.02, 0.2, 2.0}) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
      ContactDetector detector;
      bool early = false;
      support::simulate(support::random_approach(stiffness, seed), 1, [&](ApproachSample& sample) {
        sample.force = kPush;
        early = detector.step(sample) && sample.position < kBeforeIt;
        return !detector.touched();
      });
      ASSERT_TRUE(detector.touched() && !early) << stiffness << " " << seed;
      const auto estimate = estimate_contact(detector.samples());
      ASSERT_TRUE(estimate);
      EXPECT_NEAR(estimate->position, 0, 0.9) << stiffness << " " << seed;
    }
  }
}

TEST(ContactDetection, MeasuresTheStiffness) {
  for (const double stiffness : {0.1, 1.0, 5.0}) {
    support::Approach approach;
    approach.stiffness = stiffness;
    const Touch touch = approach_until_touch(approach);
    const auto estimate = estimate_contact(touch.samples);
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(estimate->stiffness / stiffness, 1, 0.5) << stiffness;
    EXPECT_NEAR(estimate->speed, kSpeedLimit, 6);
  }
}

TEST(ContactDetection, MovesWithTheOriginOfTimeAndPlace) {
  const Touch touch = approach_until_touch(support::random_approach(0.5, 3));
  const auto here = estimate_contact(touch.samples);
  std::vector<ApproachSample> moved = touch.samples;
  for (ApproachSample& sample : moved) {
    sample.time += 128;
    sample.position -= 512;
  }
  const auto there = estimate_contact(moved);
  ASSERT_TRUE(here && there);
  EXPECT_NEAR(there->time - 128, here->time, 1e-6);
  EXPECT_NEAR(there->position + 512, here->position, 1e-4);
}

TEST(ContactDetection, SaysNothingAboutAnApproachWithoutContact) {
  support::Approach approach = support::random_approach(0, 5);
  approach.free_path = 6;
  EXPECT_FALSE(estimate_contact(approach_until_touch(approach, 1).samples));
}

TEST(ContactDetection, StopsAtAFaultAndNamesIt) {
  ContactDetector detector;
  for (int i = 0; i < 40; ++i) detector.step({.time = i * 1e-3, .position = 1e-4 * i * i});
  EXPECT_FALSE(detector.step({.time = 0.04, .position = kNaN}));
  EXPECT_EQ(detector.fault(), SignalFault::not_finite);
  EXPECT_EQ(detector.samples().size(), 40u);
}

TEST(ContactDetection, EndsAnApproachThatTakesTooLong) {
  ContactOptions options;
  options.longest_approach = 0.05;
  ContactDetector detector(options);
  for (int i = 0; i < 51; ++i) detector.step({.time = i * 1e-3, .position = 0.03 * i});
  EXPECT_EQ(detector.fault(), SignalFault::too_long);
}

TEST(ContactDetection, RefusesBadSamplesByName) {
  std::vector<ApproachSample> samples = approach_until_touch({}).samples;
  EXPECT_EQ(refusal([&] { return estimate_contact(std::span(samples).first(19)); }),
            "estimate_contact: got 19 samples; it needs at least 20 from the start of the approach "
            "to the touch");
  samples[30].time = samples[29].time;
  EXPECT_EQ(refusal([&] { return estimate_contact(samples); }),
            "estimate_contact: sample 30 of the approach: time does not increase; repeat the "
            "approach");
}

TEST(ContactDetection, ChecksOptionsByName) {
  ContactOptions options;
  options.model.mass = 0;
  EXPECT_EQ(refusal([&] { return ContactDetector(options); }),
            "ApproachModel::mass is 0 kg; it must be > 0 and finite");
}

}  // namespace
}  // namespace palpate::probing
