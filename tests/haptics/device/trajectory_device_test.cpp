// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/trajectory_device.h"

#include <gtest/gtest.h>

#include <chrono>

#include "refusal.h"

namespace palpate::haptics {
namespace {

const std::vector<TrajectoryPoint> kLine = {{0, {0, 0, 0}}, {0.1, {0, 0, 10}}};

TEST(TrajectoryDevice, FollowsItsPathOnItsOwnClock) {
  TrajectoryDevice device{TimedPath(kLine)};
  device.activate();
  devices::DeviceState state;
  for (int tick = 0; tick < 200; ++tick) {
    ASSERT_TRUE(device.read(state));
    EXPECT_EQ(state.time, device.now());
    EXPECT_NEAR(state.tip.z(), std::min(0.1 * tick, 10.0), 1e-9) << tick;
    EXPECT_TRUE(device.write({.force = {0, 0, 5}}));
  }
}

TEST(TrajectoryDevice, KeepsTheHostsTime) {
  TrajectoryDevice device(TimedPath(kLine), {.real_time = true});
  EXPECT_TRUE(device.description().real_time);
  devices::DeviceState state;
  const auto begin = std::chrono::steady_clock::now();
  for (int tick = 0; tick < 20; ++tick) ASSERT_TRUE(device.read(state));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::microseconds(19900));
  EXPECT_LT(std::abs(device.now() - state.time), 0.5);
}

TEST(TrajectoryDevice, TakesForcesOnlyWhileItIsArmed) {
  TrajectoryDevice device{TimedPath(kLine)};
  EXPECT_FALSE(device.write({}));
  device.activate();
  EXPECT_TRUE(device.write({}));
  device.stop();
  EXPECT_FALSE(device.write({}));
}

TEST(TrajectoryDevice, RefusesAPeriodOfZero) {
  EXPECT_NE(refusal([] {
              return TrajectoryDevice(TimedPath(kLine), {.period = 0}).now();
            }).find("TrajectoryDeviceOptions::period"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
