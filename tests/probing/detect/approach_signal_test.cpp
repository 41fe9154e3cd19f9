// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/approach_signal.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "not_finite.h"
#include "refusal.h"
#include "simulated_approach.h"

namespace palpate::probing {
namespace {

/// The fault of a free approach of 0.2 s whose samples are changed by `spoil`, and when it came.
struct Found {
  SignalFault fault = SignalFault::none;
  int sample = -1;
};

Found fault_of(const std::function<void(int, ApproachSample&)>& spoil) {
  SignalCheck check;
  support::Approach approach;
  approach.free_path = 1e3;
  Found found;
  int count = 0;
  support::simulate(approach, 0.2, [&](ApproachSample& sample) {
    sample.force = 0.05;
    ApproachSample seen = sample;
    spoil(count, seen);
    found = {check.check(seen), count++};
    return found.fault == SignalFault::none;
  });
  return found;
}

TEST(ApproachSignal, IsAcceptedFromAnArmThatMovesFreely) {
  EXPECT_EQ(fault_of([](int, ApproachSample&) {}).fault, SignalFault::none);
}

TEST(ApproachSignal, IsRefusedByNameAtTheSampleThatIsWrong) {
  const auto expect = [](SignalFault fault, int sample,
                         const std::function<void(int, ApproachSample&)>& spoil) {
    const Found found = fault_of(spoil);
    EXPECT_EQ(to_string(found.fault), to_string(fault));
    EXPECT_EQ(found.sample, sample) << to_string(fault);
  };
  expect(SignalFault::not_finite, 50, [](int i, ApproachSample& s) {
    if (i == 50) s.position = kNaN;
  });
  expect(SignalFault::not_finite, 51, [](int i, ApproachSample& s) {
    if (i == 51) s.time = kInf;
  });
  expect(SignalFault::not_finite, 52, [](int i, ApproachSample& s) {
    if (i == 52) s.force = kNaN;
  });
  expect(SignalFault::time_backwards, 60, [](int i, ApproachSample& s) {
    if (i == 60) s.time -= 0.0015;
  });
  expect(SignalFault::time_backwards, 61, [](int i, ApproachSample& s) {
    if (i == 61) s.time -= 0.001;
  });
  expect(SignalFault::gap, 70, [](int i, ApproachSample& s) {
    if (i >= 70) s.time += 0.004;
  });
  expect(SignalFault::jump, 80, [](int i, ApproachSample& s) {
    if (i >= 80) s.position += 1.5;
  });
  double held = 0;
  expect(SignalFault::frozen, 191, [&](int i, ApproachSample& s) {
    if (i == 90) held = s.position;
    if (i > 90) s.position = held;
  });
}

TEST(ApproachSignal, IsRefusedForChatterButNotForNoiseOfAQuantum) {
  EXPECT_EQ(fault_of([](int i, ApproachSample& s) { s.position += i % 2 == 0 ? 0 : 0.03; }).fault,
            SignalFault::none);
  EXPECT_EQ(fault_of([](int i, ApproachSample& s) { s.position += i % 2 == 0 ? 0 : 0.5; }).fault,
            SignalFault::chatter);
}

TEST(ApproachSignal, FaultStays) {
  SignalCheck check;
  check.check({.time = 1, .position = 1});
  EXPECT_EQ(check.check({.time = 0.5, .position = 1}), SignalFault::time_backwards);
  EXPECT_EQ(check.check({.time = 1.001, .position = 1.01}), SignalFault::time_backwards);
}

TEST(ApproachSignal, OptionsAreCheckedByName) {
  EXPECT_EQ(refusal([] { return SignalCheck({.quantum = 0}); }),
            "SignalOptions::quantum is 0 mm; it must be > 0 and finite");
  EXPECT_EQ(refusal([] { return SignalCheck({.chatter_runs = 9}); }),
            "SignalOptions::chatter_runs is 9; it must be in [1, 8]");
}

}  // namespace
}  // namespace palpate::probing
