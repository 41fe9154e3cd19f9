// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "height_field_model.h"
#include "palpate/haptics/playback.h"
#include "sheet_model.h"
#include "tissue.h"

namespace palpate::haptics {
namespace {

constexpr double kRateTick = 1e-3;       // [s]
constexpr double kSolidStiffness = 0.5;  // [N/mm]
const RateTerm kSolidTerm{.share = 0.6, .time = 0.08};

// A flat object whose forces are linear, k d, to 1e-7, with a rate: a standard linear solid.
Model linear_solid(const std::vector<RateTerm>& rate = {kSolidTerm}) {
  Model model = sheet_model(5);
  for (ContactModel& contact : model.contacts) contact.field = spring(1e4 * kSolidStiffness, 1e4);
  model.rate = rate;
  return model;
}

// [N] normal force of a motion from just above the surface, tick by tick.
std::vector<TissueMoment> press_solid(const Playback& playback,
                                      const std::function<double(double)>& depth, double duration) {
  std::vector<TissueMoment> moments;
  LoopState state;
  static_cast<void>(playback.step({3, -5, 699.9}, state, kRateTick));
  for (long k = 0; static_cast<double>(k) * kRateTick <= duration; ++k) {
    const double time = static_cast<double>(k) * kRateTick;
    const Command command = playback.step({3, -5, 700 + depth(time)}, state, kRateTick);
    moments.push_back({time, depth(time), -command.force.z()});
  }
  return moments;
}

TEST(PlaybackRate, RampAndRestAreThoseOfAStandardLinearSolid) {
  constexpr double kSpeed = 20, kDeepest = 3;  // [mm/s], [mm]
  const auto depth = [=](double time) { return std::min(kSpeed * time, kDeepest); };
  for (const TissueMoment& at : press_solid(Playback(linear_solid()), depth, 1)) {
    const double ramp = std::min(at.time, kDeepest / kSpeed);
    const double ahead = kSpeed * kSolidTerm.time * -std::expm1(-ramp / kSolidTerm.time) *
                         std::exp(-(at.time - ramp) / kSolidTerm.time);
    // Within a tick the tool's motion is taken as at its beginning: half a tick of the speed.
    const double tolerance = 0.55 * kRateTick * kSpeed * kSolidTerm.share * kSolidStiffness;
    EXPECT_NEAR(at.force, kSolidStiffness * (at.depth + kSolidTerm.share * ahead), tolerance)
        << at.time;
  }
}

TEST(PlaybackRate, ForceLeadsDepthByThePhaseOfTheSolid) {
  const std::vector<RateTerm> two = {{0.4, 0.02}, {0.5, 0.3}};
  for (const std::vector<RateTerm>& rate : {std::vector<RateTerm>{kSolidTerm}, two}) {
    const Playback playback(linear_solid(rate));
    for (const double hertz : {2.0, 3.0}) {
      const Response found =
          response_of(press_solid(playback, swinging(4, 0.8, hertz), 4), hertz, 4);
      const std::complex<double> omega(0, 2 * std::numbers::pi * hertz);
      std::complex<double> modulus = kSolidStiffness;
      for (const RateTerm& term : rate)
        modulus += kSolidStiffness * term.share * omega * term.time / (1.0 + omega * term.time);
      EXPECT_NEAR(found.ratio, std::abs(modulus), 0.005 * std::abs(modulus)) << hertz;
      EXPECT_NEAR(found.lead, std::arg(modulus), 0.006) << hertz;  // a third of a degree
      EXPECT_GT(found.lead, 0.1);
    }
  }
}

TEST(PlaybackRate, AStepFadesToTheForceOfTheField) {
  PlaybackOptions options;
  options.largest_jump = 10;
  const Playback playback(linear_solid(), options);
  LoopState state;
  static_cast<void>(playback.step({0, 0, 699}, state, kRateTick));
  for (int k = 0; k < 1000; ++k) {
    const Command command = playback.step({0, 0, 702}, state, kRateTick);
    const double truth =
        2 * kSolidStiffness * (1 + kSolidTerm.share * std::exp(-k * kRateTick / kSolidTerm.time));
    EXPECT_NEAR(-command.force.z(), truth, 1e-6) << k;
  }
}

TEST(PlaybackRate, AToolThatReturnsFasterThanTheObjectIsNotPulled) {
  const Playback playback(linear_solid());
  LoopState state;
  static_cast<void>(playback.step({0, 0, 699}, state, kRateTick));
  double before = 0;
  int touching = 0;
  for (int k = 0; k < 1500; ++k) {
    const double time = k * kRateTick;
    const double depth = time < 1 ? std::min(10 * time, 3.0) : 3 - 100 * (time - 1);
    const Command command = playback.step({0, 0, 700 + depth}, state, kRateTick);
    EXPECT_LE(command.force.z(), 0) << k;
    EXPECT_LT(std::abs(command.force.z() - before), 0.1) << k;
    before = command.force.z();
    touching += command.state != ContactState::free;
    EXPECT_FALSE(command.limited) << k;
  }
  EXPECT_NEAR(touching, 1030, 3);  // until the tool is out
}

TEST(PlaybackRate, FastMotionsInAndOutGiveTheUserNoEnergy) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Playback playback(linear_solid({{1.5, 0.03}, {0.8, 0.5}}));
  LoopState state;
  Eigen::Vector3d tool(0, 0, 699), force = Eigen::Vector3d::Zero();
  static_cast<void>(playback.step(tool, state, kRateTick));
  double work = 0, least = 0, most = 0;
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector3d from = tool, to(0.5 * uniform(random), 0.5 * uniform(random),
                                          700.6 + 1.6 * uniform(random));
    const double speed = 20 * std::exp(1.5 * uniform(random));  // [mm/s] 4 to 90
    const int ticks = 1 + static_cast<int>((to - from).norm() / speed / kRateTick);
    for (int i = 1; i <= ticks; ++i) {
      const Eigen::Vector3d next = from + (to - from) * i / ticks;
      const Command command = playback.step(next, state, kRateTick);
      work -= (force + command.force).dot(next - tool) / 2;
      force = command.force;
      tool = next;
      most = std::max(most, work);
      least = std::min(least, work);
    }
  }
  EXPECT_GT(most, 10);  // [N mm] put in, over all
  EXPECT_GT(least, -0.05);
}

TEST(PlaybackRate, PressingSlidingAndLiftingGivesTheUserNoEnergy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double friction : {0.1, 0.5}) {
    Model model = height_field_model({.height = waves, .friction = friction, .uneven = true});
    model.rate = {{0.5, 0.05}, {0.4, 0.4}};
    const Playback playback(model);
    double most = 0;
    int slips = 0;
    for (int i = 0; i < 25; ++i) {
      const double x = 12 * uniform(random), y = 12 * uniform(random);
      const double angle = 3.2 * uniform(random), length = 7.5 * (1 + uniform(random));
      Eigen::Vector3d tool(x, y, waves(x, y) + 1), force = Eigen::Vector3d::Zero();
      const Eigen::Vector3d pressed = tool - (4 + uniform(random)) * Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d away =
          pressed + length * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      LoopState state;
      double work = 0;
      static_cast<void>(playback.step(tool, state, kRateTick));
      for (const Eigen::Vector3d& to :
           {pressed, away, Eigen::Vector3d(away + 12 * Eigen::Vector3d::UnitZ())}) {
        const Eigen::Vector3d from = tool;
        const double speed = 60 * std::exp(uniform(random));  // [mm/s]
        const int ticks = 1 + static_cast<int>((to - from).norm() / speed / kRateTick);
        for (int k = 1; k <= ticks; ++k) {
          const Eigen::Vector3d next = from + (to - from) * k / ticks;
          const Command command = playback.step(next, state, kRateTick);
          slips += command.state == ContactState::slip;
          work -= (force + command.force).dot(next - tool) / 2;
          force = command.force;
          tool = next;
        }
      }
      EXPECT_TRUE(force.isZero(0));
      most = std::max(most, -work);
    }
    EXPECT_LT(most, 0.05) << friction;  // [N mm], as without a rate
    EXPECT_GT(slips, 100);
  }
}

TEST(PlaybackRate, IsTakenIntoAccountByTheBracketedRuleOnly) {
  PlaybackOptions options;
  options.motion = ContactMotion::brent;
  EXPECT_THAT(refusal([&] { return Playback(linear_solid(), options); }),
              ::testing::HasSubstr("bracketed"));
}

}  // namespace
}  // namespace palpate::haptics
