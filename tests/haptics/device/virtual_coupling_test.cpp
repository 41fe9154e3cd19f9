// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/virtual_coupling.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "not_finite.h"
#include "refusal.h"

namespace palpate::haptics {
namespace {

// The hands of Colgate and Schenkel's bound at 1 kHz with one tick of delay.
TEST(PassiveStiffness, IsTheBoundOfColgateAndSchenkel) {
  EXPECT_NEAR(passive_stiffness(0.5e-3, 1e-3, 1e-3), 1.0 / 3, 1e-12);
  EXPECT_NEAR(passive_stiffness(10e-3, 1e-3, 1e-3), 20.0 / 3, 1e-12);
  EXPECT_NEAR(passive_stiffness(2e-3, 1e-3, 0), 4, 1e-12);
  EXPECT_NEAR(passive_damping(passive_stiffness(3e-3, 2e-3, 1e-3), 2e-3, 1e-3), 3e-3, 1e-15);
}

TEST(QuietStiffness, IsWhereFrictionHoldsHalfAStepOfTheEncoder) {
  EXPECT_NEAR(quiet_stiffness(0.05, 0.02), 5, 1e-12);
  EXPECT_NEAR(quiet_friction(5, 0.02), 0.05, 1e-12);
  EXPECT_EQ(quiet_stiffness(0, 0.02), 0);
  EXPECT_EQ(quiet_stiffness(0, 0), kInf);
}

TEST(CouplingStiffness, FollowsFromDampingAndDelay) {
  CouplingOptions options;
  EXPECT_NEAR(coupling_stiffness(options, 5e-3, 1e-3, 1e-3), 0.5 * 5.0 / 1.5, 1e-12);
  EXPECT_NEAR(coupling_stiffness(options, 0, 1e-3, 1e-3), 0.5 / 3, 1e-12);  // of a light grip
  options.stiffness = 2;
  EXPECT_EQ(coupling_stiffness(options, 5e-3, 1e-3, 1e-3), 2);
}

TEST(Couple, IsFreeInFreeSpace) {
  CouplingState state;
  const Eigen::Vector3d device(1, 2, 3);
  const CoupledTool tool = couple(
      {}, 1, device, state, [](const Eigen::Vector3d&) { return Eigen::Vector3d::Zero().eval(); });
  EXPECT_EQ(tool.tool, device);
  EXPECT_EQ(tool.force, Eigen::Vector3d::Zero());
}

TEST(Couple, IsASpringInSeriesWithAWall) {
  constexpr double kSpring = 2;  // [N/mm]
  for (const double wall : {0.01, 0.5, 10.0, 1000.0}) {
    CouplingState state;
    const CouplingOptions options{.tolerance = 1e-4};
    int calls = 0, ticks = 0, unbalanced = 0;
    const auto model = [&](const Eigen::Vector3d& tool) -> Eigen::Vector3d {
      ++calls;
      return {0, 0, std::max(-wall * tool.z(), 0.0)};
    };
    // Presses, moves aside and lifts off, 0.05 mm a tick.
    for (int i = 0; i < 400; ++i, ++ticks) {
      const Eigen::Vector3d device(0.01 * i, 0, 3 - 0.05 * std::min(i, 400 - i));
      const CoupledTool tool = couple(options, kSpring, device, state, model);
      if (tool.residual > 1e-4) {  // may happen in the tick in which it touches
        ++unbalanced;
        continue;
      }
      const double series = kSpring * wall / (kSpring + wall);
      EXPECT_NEAR(tool.force.z(), std::max(-series * device.z(), 0.0), 2e-4) << wall << ' ' << i;
      EXPECT_NEAR(tool.force.head<2>().norm(), 0, 2e-4);
    }
    EXPECT_LE(unbalanced, 1) << wall;
    EXPECT_LT(calls, 3 * ticks) << wall;
  }
}

TEST(Couple, BalancesAnAnisotropicModel) {
  Eigen::Matrix3d object;
  object << 3, 1, 0.2, 1, 8, -0.5, 0.2, -0.5, 0.4;
  CouplingState state;
  const CouplingOptions options{.tolerance = 1e-6};
  Eigen::Vector3d device = Eigen::Vector3d::Zero();
  for (int i = 1; i < 60; ++i) {
    device = {0.05 * std::sin(0.1 * i), 0.02 * i, -0.03 * i};
    const CoupledTool tool =
        couple(options, 1, device, state,
               [&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return -(object * p); });
    const Eigen::Vector3d exact = (Eigen::Matrix3d::Identity() + object).lu().solve(device);
    EXPECT_LT((tool.tool - exact).norm(), i < 4 ? 1e-3 : 1e-5) << i;
  }
}

TEST(Couple, CallsTheModelLastWithTheToolItFound) {
  CouplingState state;
  Eigen::Vector3d last;
  const auto rough = [&](const Eigen::Vector3d& tool) -> Eigen::Vector3d {
    last = tool;
    // Jumps about without a balance.
    return {std::sin(1e4 * tool.x()), std::cos(3e4 * tool.z()), 5 * std::sin(1e5 * tool.y())};
  };
  for (int i = 0; i < 100; ++i) {
    const CoupledTool tool =
        couple({}, 1, Eigen::Vector3d(0.01 * i, 0.02 * i, -0.01 * i), state, rough);
    EXPECT_EQ(last, tool.tool);
    EXPECT_TRUE(tool.force.allFinite());
  }
}

TEST(Couple, PassesOnThatAModelIsNotFinite) {
  CouplingState state;
  const auto broken = [](const Eigen::Vector3d&) -> Eigen::Vector3d {
    return Eigen::Vector3d::Constant(std::nan(""));
  };
  EXPECT_TRUE(couple({}, 1, Eigen::Vector3d::Zero(), state, broken).force.hasNaN());
  EXPECT_FALSE(state.touching);
}

TEST(CheckCoupling, RefusesWhatCannotBe) {
  const auto message = [](const CouplingOptions& options) {
    return refusal([&] {
      check_coupling(options);
      return 0;
    });
  };
  EXPECT_NE(message({.stiffness = 0}).find("CouplingOptions::coupling_stiffness"),
            std::string::npos);
  EXPECT_NE(message({.safety = 1.1}).find("CouplingOptions::coupling_safety"), std::string::npos);
  EXPECT_NE(message({.most_steps = 0}).find("CouplingOptions::coupling_steps"), std::string::npos);
  EXPECT_EQ(
      message({.on = false, .stiffness = 1}),
      "CouplingOptions::coupling_stiffness does nothing with CouplingOptions::coupling (off)");
  EXPECT_EQ(message({.stiffness = 1, .safety = 0.4}),
            "CouplingOptions::coupling_safety does nothing with "
            "CouplingOptions::coupling_stiffness 1");
}

}  // namespace
}  // namespace palpate::haptics
