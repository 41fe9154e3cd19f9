// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/plugin_device.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "palpate/core/error.h"
#include "palpate/devices/safe_device.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::devices {
namespace {

const std::filesystem::path kDriver = PALPATE_POINT_MASS_DEVICE;

TEST(PluginDevice, MovesAsItsDriverSimulates) {
  PluginDevice arm(kDriver, {{"mass", "0.2"}});
  EXPECT_EQ(arm.description().name, "point mass");
  EXPECT_FALSE(arm.description().measures_joints);
  EXPECT_TRUE(arm.description().measures_force);
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.read(state));
  const double begin = state.time, place = state.tip.y();
  // The lease outlasts a pause of a loaded machine.
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(arm.write({.force = {0, 0.4, 0}, .lease = 1}));
    ASSERT_TRUE(arm.read(state));
  }
  // At least 30 periods from rest with 2000 mm/s^2, little slowed down by friction.
  const double time = state.time - begin;
  EXPECT_GE(time, 0.0299);
  EXPECT_GT(state.tip.y() - place, 0.5 * 1000 * 0.03 * 0.03 * 0.8);
  EXPECT_TRUE(state.joints.hasNaN());
  EXPECT_TRUE(state.reference_force.hasNaN());
  EXPECT_FALSE(arm.description().measures_reference);
  EXPECT_NEAR(state.delivered_force.y(), 0.4, 1e-5);
  EXPECT_LE(arm.now() - state.time, 0.5);
  arm.stop();
  EXPECT_FALSE(arm.write({}));
  EXPECT_EQ(arm.last_error(), "write before activate");
}

TEST(PluginDevice, DropsTheForceWhenTheLeaseEnds) {
  PluginDevice arm(kDriver);
  arm.activate();
  ASSERT_TRUE(arm.write({.force = {1, 0, 0}, .lease = 0}));
  DeviceState state;
  ASSERT_TRUE(arm.read(state));
  EXPECT_NEAR(state.delivered_force.x(), 0, 1e-5);
}

TEST(PluginDevice, TakesTheClockOfADriverThatHasOne) {
  PluginDevice simulated(PALPATE_VIRTUAL_DEVICE);
  EXPECT_TRUE(simulated.description().measures_joints);
  EXPECT_FALSE(simulated.description().real_time);
  EXPECT_TRUE(simulated.description().measures_reference);
  simulated.activate();
  DeviceState state;
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(simulated.read(state));
    EXPECT_NEAR(simulated.now(), 1e-3 * i, 1e-12);
    EXPECT_EQ(simulated.now(), state.time);
    EXPECT_EQ(state.reference_force, Eigen::Vector3d::Zero());  // in free space
  }
  EXPECT_TRUE(PluginDevice(kDriver).description().real_time);
}

TEST(PluginDevice, CarriesWhatPlaybackNeeds) {
  PluginDevice arm(kDriver);
  const DeviceDescription& description = arm.description();
  EXPECT_EQ(description.highest_torque, 80);
  EXPECT_NEAR(description.damping, 5e-4, 1e-18);
  EXPECT_EQ(description.friction, 0.04);
  EXPECT_EQ(description.resolution, 0.01);
  EXPECT_EQ(description.delay, 1e-3);
  EXPECT_EQ(description.workspace_scale, 3);
  EXPECT_EQ(description.clutch_buttons, 2U);
  EXPECT_TRUE(description.measures_velocity);
  EXPECT_TRUE(description.measures_orientation);
  EXPECT_TRUE(description.reports_armed);
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.write({.force = {0, 0.3, 0}, .lease = 1, .torque = {0, 0, 1}}));
  ASSERT_TRUE(arm.read(state));
  EXPECT_GT(state.velocity.y(), 0);
  EXPECT_EQ(state.orientation, Eigen::Vector4d(1, 0, 0, 0));
  EXPECT_EQ(state.buttons, 1U);
  EXPECT_TRUE(state.armed);
  EXPECT_FALSE(state.clutched);
  ASSERT_TRUE(arm.write({.torque = {0, 0, 3}}));
  ASSERT_TRUE(arm.read(state));
  EXPECT_EQ(state.buttons, 3U);
  EXPECT_FALSE(state.clutched) << "which button clutches is known to the loop";
  arm.stop();
  ASSERT_TRUE(arm.read(state));
  EXPECT_FALSE(state.armed);
}

TEST(PluginDevice, OpensEachOfSeveralDevices) {
  EXPECT_EQ(PluginDevice(kDriver, {}, 0).description().highest_force, 5);
  EXPECT_EQ(PluginDevice(kDriver, {}, 1).description().highest_force, 9);
  EXPECT_NE(refusal([] {
              return PluginDevice(kDriver, {}, 2).now();
            }).find("there is no device 2; the driver finds 2"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              return PluginDevice(PALPATE_VIRTUAL_DEVICE, {}, 1).now();
            }).find("there is no device 1; the driver finds 1"),
            std::string::npos);
}

// Built before playback's fields were added: their sizes end where they began.
TEST(PluginDevice, TakesADriverThatKnowsNothingOfPlayback) {
  PluginDevice arm(PALPATE_VIRTUAL_DEVICE);
  EXPECT_EQ(arm.description().damping, 0);
  EXPECT_EQ(arm.description().workspace_scale, 1);
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.read(state));
  EXPECT_TRUE(state.armed);
  EXPECT_FALSE(state.clutched);
  EXPECT_TRUE(state.velocity.hasNaN());
  EXPECT_EQ(state.buttons, 0U);
}

TEST(PluginDevice, PassesOnThatItsDriverSaysNanOrRefuses) {
  PluginDevice nan(PALPATE_BROKEN_DEVICE, {{"fault", "nan"}, {"at", "1"}});
  DeviceState state;
  ASSERT_TRUE(nan.read(state));
  EXPECT_TRUE(state.tip.allFinite());
  ASSERT_TRUE(nan.read(state));
  EXPECT_FALSE(state.tip.allFinite());
  PluginDevice refusing(PALPATE_BROKEN_DEVICE, {{"fault", "refuse"}, {"at", "0"}});
  EXPECT_FALSE(refusing.read(state));
  EXPECT_EQ(refusing.last_error(), "broken as told");
}

TEST(PluginDevice, RefusesADeviceWhoseForcesHaveNoLimit) {
  EXPECT_THROW(PluginDevice(PALPATE_BROKEN_DEVICE, {}, 1), DeviceError);
}

TEST(PluginDevice, SaysWhatItsDriverSays) {
  try {
    const PluginDevice arm(kDriver, {{"mass", "-1"}});
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_EQ(std::string(error.what()),
              kDriver.string() + ": option mass = -1: mass must be > 0 kg");
  }
}

TEST(PluginDevice, RefusesWhatIsNoDriver) {
  const ScratchFolder folder;
  const auto text = folder / "driver.so";
  std::ofstream(text) << "no library";
  EXPECT_NE(refusal([&] { return PluginDevice(text); }).find("is not a driver that can be loaded"),
            std::string::npos);
  EXPECT_NE(refusal([&] { return PluginDevice(folder / "missing.so"); }).find("missing.so"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              return PluginDevice("libm.so.6");
            }).find("has no function palpate_device(); see palpate/devices/device_plugin.h"),
            std::string::npos);
}

TEST(PluginDevice, RefusesADriverOfAnotherVersion) {
  EXPECT_NE(refusal([] {
              return PluginDevice(PALPATE_OLD_DEVICE);
            }).find("the driver is for version 99 of device_plugin.h; this build needs version 1"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::devices
