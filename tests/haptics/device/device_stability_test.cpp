// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/device_stability.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "refusal.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

/// A hand without a spring of its own, 0.02 mm encoders, one tick of delay at 1 kHz.
HandOptions hand_of(double mass, double damping) {
  return {.mass = mass, .damping = damping, .stiffness = 0};
}

/// [N/mm] The stiffest spring on which mass, damper, zero-order hold and one tick of delay are
/// stable: where an eigenvalue of the sampled system reaches the unit circle.
double exact_limit(double mass, double damping) {
  constexpr double kTick = 1e-3;
  const double m = 1e-3 * mass, rate = damping / m;
  const double decay = std::exp(-rate * kTick);
  const double v_to_x = (1 - decay) / rate;
  const double f_to_v = (1 - decay) / damping;
  const double f_to_x = (kTick - v_to_x) / damping;
  const auto radius = [&](double stiffness) {
    Eigen::Matrix3d step;  // of x, v and the force that waits
    step << 1, v_to_x, f_to_x, 0, decay, f_to_v, -stiffness, 0, 0;
    return Eigen::EigenSolver<Eigen::Matrix3d>(step, false).eigenvalues().cwiseAbs().maxCoeff();
  };
  double stable = 1e-3, unstable = 1e3;
  while (unstable / stable > 1.001) {
    const double middle = std::sqrt(stable * unstable);
    (radius(middle) < 1 ? stable : unstable) = middle;
  }
  return stable;
}

struct Case {
  double mass, damping;  // [kg], [N s/mm]
  double coupled;        // [N/mm] that a prototype reached with a virtual coupling
};
constexpr Case kHands[] = {
    {0.1, 0.5e-3, 0.98}, {0.1, 2e-3, 7.3}, {0.2, 5e-3, 22}, {0.3, 10e-3, 43}};

TEST(LargestCalmStiffness, IsThatOfTheSampledSystemWithoutCoupling) {
  for (const Case& hand : kHands) {
    const double calm = largest_calm_stiffness(hand_of(hand.mass, hand.damping), {.on = false});
    const double exact = exact_limit(hand.mass, hand.damping);
    // A calm hand swings half as much after ten decay times: the limit itself never decays.
    EXPECT_GT(calm, 0.85 * exact) << hand.mass << ' ' << hand.damping;
    EXPECT_LT(calm, 1.02 * exact) << hand.mass << ' ' << hand.damping;
    // Colgate and Schenkel's bound is for any hand, so that this one may be calm above it.
    EXPECT_GT(exact, 0.95 * passive_stiffness(hand.damping, 1e-3, 1e-3));
  }
}

TEST(LargestCalmStiffness, HasNoLimitWithTheCoupling) {
  for (const Case& hand : kHands) {
    const double calm = largest_calm_stiffness(hand_of(hand.mass, hand.damping), {});
    EXPECT_GE(calm, hand.coupled);
    EXPECT_EQ(calm, 1e3) << hand.mass << ' ' << hand.damping;
  }
}

TEST(LargestCalmStiffness, IsLostWithACouplingThatIsTooStiff) {
  const HandOptions hand = hand_of(0.1, 2e-3);
  const double limit = passive_stiffness(2e-3, 1e-3, 1e-3);
  EXPECT_FALSE(presses_calmly(hand, {.stiffness = 3 * limit}, 100));
  EXPECT_TRUE(presses_calmly(hand, {.stiffness = 0.5 * limit}, 100));
}

TEST(LargestCalmStiffness, FallsWithTheDelay) {
  HandOptions hand = hand_of(0.2, 5e-3);
  double last = 1e3;
  for (const int delay : {0, 1, 3}) {
    hand.delay = delay;
    const double calm = largest_calm_stiffness(hand, {.on = false});
    EXPECT_LT(calm, 0.8 * last);
    last = calm;
  }
}

/// Returns true if a hand that pushes against a wall, on both sides of it a spring, stands still
/// for the last tenth of 4 s.
bool stands_still(const HandOptions& options, const CouplingOptions& coupling, double stiffness) {
  SimulatedHand hand(TimedPath({{0, Eigen::Vector3d::Zero()}}), options);
  hand.activate();
  const auto wall = [&](const Eigen::Vector3d& tool) -> Eigen::Vector3d {
    return -stiffness * tool;
  };
  const double spring = coupling_stiffness(coupling, options.damping, options.period(),
                                           options.delay * options.period());
  CouplingState state;
  devices::DeviceState measured;
  Eigen::Vector3d place;
  constexpr int kTicks = 4000;
  for (int tick = 0; tick < kTicks; ++tick) {
    EXPECT_TRUE(hand.read(measured));
    const Eigen::Vector3d force = coupling.on
                                      ? couple(coupling, spring, measured.tip, state, wall).force
                                      : wall(measured.tip);
    EXPECT_TRUE(hand.write({.force = force}));
    if (tick == kTicks * 9 / 10) place = hand.position();
    if (tick > kTicks * 9 / 10 && hand.position() != place) return false;
  }
  return true;
}

// Between two steps of the encoder nothing but dry friction balances a hand.
TEST(QuietStiffness, IsTheLargestOnWhichEveryHandAtRestStandsStill) {
  constexpr double kStep = 0.02, kFriction = 0.01;  // [mm], [N]
  const double quiet = quiet_stiffness(kFriction, kStep);
  HandOptions hand = hand_of(0.2, 5e-3);
  hand.encoder_step = kStep;
  hand.friction = kFriction;
  int still = 0;
  for (const double ratio : {0.3, 0.6, 0.9, 1.1, 1.5, 2.0}) {
    const double stiffness = ratio * quiet;
    for (const double between : {0.0, 0.25, 0.5, 0.75}) {  // steps of force
      hand.push.z() = -(10 + between) * kStep * stiffness;
      const bool stands = stands_still(hand, {.on = false}, stiffness);
      if (ratio < 1) {
        EXPECT_TRUE(stands) << ratio << ' ' << between;
      } else if (between == 0.5) {
        EXPECT_FALSE(stands) << ratio;
      }
      still += stands;
    }
  }
  EXPECT_GT(still, 12) << "on steps of force a hand stands still at any stiffness";
  hand.friction = 0;
  hand.push.z() = -10.5 * kStep * 0.1 * quiet;
  EXPECT_FALSE(stands_still(hand, {.on = false}, 0.1 * quiet)) << "without friction never";
}

TEST(QuietStiffness, IsThatOfWhatIsFeltThroughTheCoupling) {
  HandOptions hand = hand_of(0.2, 5e-3);
  hand.push.z() = -1;
  constexpr double kWall = 100;  // [N/mm]
  const double spring =
      coupling_stiffness({}, hand.damping, hand.period(), hand.delay * hand.period());
  const double needed = quiet_friction(spring * kWall / (spring + kWall), hand.encoder_step);
  hand.friction = 1.3 * needed;
  EXPECT_TRUE(stands_still(hand, {}, kWall));
}

TEST(ModelStiffness, IsThatOfTheSpringsOfAModel) {
  // w d / sqrt(d^2 + epsilon^2) is stiffest at rest: w / epsilon.
  Model model = sheet_model();
  model.contacts[2].field = spring(12, 10);
  const ModelStiffness found = model_stiffness(model);
  EXPECT_NEAR(found.median, 0.4, 1e-12);
  EXPECT_NEAR(found.largest, 1.2, 1e-12);
  EXPECT_EQ(found.stiffest, model.contacts[2].id);
  model.rate = {{0.5, 0.1}, {0.25, 1}};
  EXPECT_NEAR(model_stiffness(model).largest, 1.75 * 1.2, 1e-12);
}

TEST(ModelStiffness, SeesABaseThatLiesDeeper) {
  Model model = sheet_model();
  model.contacts[1].field.bases.push_back(
      {.weight = 0.5, .epsilon = 0.1, .center = {0, 0, 3}});  // 5 N/mm at a depth of 3 mm
  EXPECT_NEAR(model_stiffness(model).largest, 5.4, 0.1);
  EXPECT_NE(refusal([&] { return model_stiffness(model, 0); }).find("highest_force"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
