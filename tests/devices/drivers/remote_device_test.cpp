// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/remote_device.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>

#include "palpate/core/error.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::devices {
namespace {

RemoteDeviceOptions hosted(std::map<std::string, std::string> driver = {}) {
  return {.driver = std::move(driver), .host = PALPATE_DEVICE_HOST};
}

std::string words_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

bool says(const std::string& words, const std::string& part) {
  return words.find(part) != std::string::npos;
}

TEST(RemoteDevice, MovesAsItsDriverSimulates) {
  RemoteDevice arm(PALPATE_POINT_MASS_DEVICE, hosted({{"mass", "0.2"}}));
  EXPECT_EQ(arm.description().name, "point mass");
  EXPECT_TRUE(arm.description().measures_force);
  EXPECT_TRUE(arm.description().real_time);
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.read(state));
  const double begin = state.time, place = state.tip.y();
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(arm.write({.force = {0, 0.4, 0}, .lease = 1}));
    ASSERT_TRUE(arm.read(state));
  }
  EXPECT_GE(state.time - begin, 0.0299);
  EXPECT_GT(state.tip.y() - place, 0.5 * 1000 * 0.03 * 0.03 * 0.8);
  EXPECT_TRUE(state.joints.hasNaN());
  EXPECT_NEAR(state.delivered_force.y(), 0.4, 1e-5);
  EXPECT_LE(arm.now() - state.time, 0.5);
  arm.stop();
  static_cast<void>(arm.write({.force = {0, 1, 0}}));
  ASSERT_TRUE(arm.read(state));
  EXPECT_FALSE(arm.write({})) << "the driver refused the command before";
  EXPECT_EQ(arm.last_error(), "write before activate");
}

TEST(RemoteDevice, TakesTheClockOfADriverThatHasOne) {
  RemoteDevice arm(PALPATE_VIRTUAL_DEVICE, hosted());
  EXPECT_FALSE(arm.description().real_time);
  arm.activate();
  DeviceState state;
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(arm.read(state));
    EXPECT_NEAR(arm.now(), 1e-3 * i, 1e-12);
    EXPECT_EQ(arm.now(), state.time);
  }
}

// The driver keeps a force for a second; its host does not.
TEST(RemoteDevice, LetsItsHostDropTheForceWhenTheLeaseEnds) {
  RemoteDevice arm(PALPATE_POINT_MASS_DEVICE, hosted({{"forget_lease", "1"}}));
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.write({.force = {1, 0, 0}, .lease = 0.5}));
  ASSERT_TRUE(arm.read(state));
  EXPECT_NEAR(state.delivered_force.x(), 1, 1e-5);
  ASSERT_TRUE(arm.write({.force = {1, 0, 0}, .lease = 0.02}));
  std::this_thread::sleep_for(std::chrono::milliseconds(80));
  ASSERT_TRUE(arm.read(state));
  EXPECT_NEAR(state.delivered_force.x(), 0, 1e-5);
}

TEST(RemoteDevice, OutlivesADriverThatCrashesWhileItIsLoaded) {
  const std::string words =
      words_of([] { const RemoteDevice arm(PALPATE_CRASHING_DEVICE, hosted()); });
  EXPECT_TRUE(says(words, "crashed: signal 6")) << words;
  EXPECT_TRUE(says(words, "while the driver was loaded")) << words;
}

TEST(RemoteDevice, OutlivesADriverThatCrashesInATick) {
  RemoteDevice arm(PALPATE_BROKEN_DEVICE, hosted({{"fault", "crash"}, {"at", "5"}}));
  arm.activate();
  DeviceState state;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(arm.read(state));
  EXPECT_FALSE(arm.read(state));
  EXPECT_FALSE(arm.read(state));
  EXPECT_FALSE(arm.write({}));
  EXPECT_TRUE(says(arm.last_error(), "crashed: signal 6")) << arm.last_error();
  EXPECT_TRUE(says(words_of([&] { arm.activate(); }), "crashed"));
}

TEST(RemoteDevice, WaitsForADriverThatStallsNoLongerThanItsTimeAndGoesOnAfterwards) {
  RemoteDevice arm(PALPATE_BROKEN_DEVICE, hosted({{"fault", "stall"}, {"at", "3"}}));
  arm.activate();
  DeviceState state;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(arm.read(state));
  const double before = state.time;
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(arm.read(state));
  EXPECT_EQ(state.time, before);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(140));
  EXPECT_EQ(arm.last_error(), "the driver's process does not answer");
  bool answered = false;
  for (int i = 0; i < 100 && !answered; ++i) answered = arm.read(state);
  EXPECT_TRUE(answered);
  // Each answer is a new state, not a late one.
  const double after = state.time;
  ASSERT_TRUE(arm.read(state));
  EXPECT_GT(state.time, after);
}

// A force that no command can take away is ended by stop.
TEST(RemoteDevice, LetsItsHostStopADriverThatRefusesToDropTheForce) {
  RemoteDevice arm(PALPATE_BROKEN_DEVICE, hosted({{"fault", "keep"}}));
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.write({.force = {1, 0, 0}, .lease = 0.05}));
  ASSERT_TRUE(arm.write({.force = {2, 0, 0}, .lease = 0.05}));
  ASSERT_TRUE(arm.read(state));
  EXPECT_EQ(state.tip.y(), 1);
  static_cast<void>(arm.write({.force = {0, 0, 0}, .lease = 0.05}));  // refused, too
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ASSERT_TRUE(arm.read(state));
  EXPECT_EQ(state.tip.y(), 0);
}

// Ctrl-C goes to the group of the terminal; the host must live until the loop has ended.
TEST(RemoteDevice, KeepsItsHostOutOfTheProcessGroupOfTheProgram) {
  RemoteDevice arm(PALPATE_BROKEN_DEVICE, hosted({{"fault", "group"}, {"at", "0"}}));
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.read(state));
  EXPECT_GT(state.tip.y(), 0);
  EXPECT_NE(state.tip.y(), static_cast<double>(getpgrp()));
}

TEST(RemoteDevice, ReadsAgainAfterAStopInAStall) {
  RemoteDevice arm(PALPATE_BROKEN_DEVICE, hosted({{"fault", "stall"}, {"at", "0"}}));
  arm.activate();
  DeviceState state;
  EXPECT_FALSE(arm.read(state));
  arm.stop();
  EXPECT_TRUE(arm.read(state));
}

// The words of a driver are not asked for again in each tick: that allocates.
TEST(RemoteDevice, AsksOnceForTheWordsOfARefusedCommand) {
  RemoteDevice arm(PALPATE_BROKEN_DEVICE, hosted({{"fault", "keep"}}));
  arm.activate();
  DeviceState state;
  ASSERT_TRUE(arm.write({.force = {1, 0, 0}, .lease = 1}));
  ASSERT_TRUE(arm.write({.force = {2, 0, 0}, .lease = 1}));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(arm.read(state));
  EXPECT_EQ(arm.last_error(), "keeps its force, asked 1 times");
}

TEST(RemoteDevice, StopsAndEndsADriverThatHangs) {
  const ScratchFolder folder;
  const auto begin = std::chrono::steady_clock::now();
  {
    RemoteDevice arm(
        PALPATE_BROKEN_DEVICE,
        hosted({{"fault", "hang"}, {"at", "0"}, {"stopped", (folder / "stopped").string()}}));
    arm.activate();
    DeviceState state;
    EXPECT_FALSE(arm.read(state));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_EQ(read_text(folder / "stopped"), "stopped");
}

TEST(RemoteDevice, SaysWhatItsDriverSays) {
  EXPECT_EQ(words_of([] {
              const RemoteDevice arm(PALPATE_POINT_MASS_DEVICE, hosted({{"mass", "-1"}}));
            }),
            std::string(PALPATE_POINT_MASS_DEVICE) + ": option mass = -1: mass must be > 0 kg");
  EXPECT_TRUE(says(words_of([] { const RemoteDevice arm(PALPATE_OLD_DEVICE, hosted()); }),
                   "the driver is for version 99 of device_plugin.h"));
  EXPECT_TRUE(says(words_of([] { const RemoteDevice arm("missing.so", hosted()); }),
                   "is not a driver that can be loaded"));
}

TEST(RemoteDevice, SaysThatItsHostIsMissing) {
  EXPECT_TRUE(
      says(refusal([] {
             return RemoteDevice(PALPATE_POINT_MASS_DEVICE, {.host = "/nowhere/host"}).now();
           }),
           "/nowhere/host: the host of drivers cannot be started"));
}

}  // namespace
}  // namespace palpate::devices
