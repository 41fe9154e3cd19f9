// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/held_arm.h"

#include <gtest/gtest.h>

#include "refusal.h"

namespace palpate::haptics {
namespace {

const Eigen::Vector3d kPlace(0, 40, 210);
TimedPath stays() { return TimedPath({{0, kPlace}}); }

TEST(HeldArm, YieldsToAForceAsTheHandThatHoldsIt) {
  // Without friction in the joints, the hand's spring alone balances the motors.
  probing::VirtualArmOptions options;
  options.friction.setZero();
  options.torque_noise = options.torque_gain_error = options.force_noise = 0;
  HeldArm arm(stays(), {.mass = 0.1, .damping = 0.005, .stiffness = 0.2}, options);
  arm.activate();
  devices::DeviceState state;
  for (int tick = 0; tick < 1500; ++tick) {
    ASSERT_TRUE(arm.read(state));
    ASSERT_TRUE(arm.write({.force = {0.5, 1, -0.4}}));
  }
  EXPECT_LT((state.tip - kPlace - Eigen::Vector3d(2.5, 5, -2)).norm(), 0.1);
}

TEST(HeldArm, IsCarriedWhereTheHandWantsIt) {
  const Eigen::Vector3d end = kPlace + Eigen::Vector3d(15, -10, 5);
  HeldArm arm(TimedPath({{0, kPlace}, {0.5, end}}, PathShape::smooth), {.stiffness = 0.5});
  arm.activate();
  devices::DeviceState state;
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_TRUE(arm.read(state));
    ASSERT_TRUE(arm.write({}));
  }
  // Joint friction of 0.05 N at the tip holds it 0.1 mm off each way.
  EXPECT_LT((state.tip - end).norm(), 0.5);
  EXPECT_TRUE(arm.description().measures_joints);
  EXPECT_EQ(arm.description().delay, arm.description().period);
}

TEST(HeldArm, RefusesAPathOutOfReach) {
  EXPECT_NE(refusal([] {
              return HeldArm(TimedPath({{0, {0, 0, 2000}}})).now();
            }).find("does not reach the beginning of the path"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
