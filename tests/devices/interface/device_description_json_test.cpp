// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/device_description_json.h"

#include <gtest/gtest.h>

#include "refusal.h"

namespace palpate::devices {
namespace {

TEST(DeviceDescriptionJson, KeepsWhatRecordsNeed) {
  const DeviceDescription device{.name = "a \"device\"",
                                 .period = 1.0 / 3,
                                 .highest_force = 4,
                                 .continuous_force = 2.5,
                                 .measures_force = true,
                                 .real_time = false,
                                 .highest_torque = 7,
                                 .damping = 1e-3 / 3,
                                 .friction = 0.1 / 3,
                                 .resolution = 0.01 / 3,
                                 .delay = 2e-3,
                                 .workspace_scale = 0.5,
                                 .clutch_buttons = 5};
  const DeviceDescription again = device_description_of(to_json(device));
  EXPECT_EQ(again.name, device.name);
  EXPECT_EQ(again.period, device.period);
  EXPECT_EQ(again.highest_force, device.highest_force);
  EXPECT_EQ(again.continuous_force, device.continuous_force);
  EXPECT_TRUE(again.measures_force);
  EXPECT_FALSE(again.measures_joints);
  EXPECT_FALSE(again.real_time);
  EXPECT_EQ(again.highest_torque, device.highest_torque);
  EXPECT_EQ(again.damping, device.damping);
  EXPECT_EQ(again.friction, device.friction);
  EXPECT_EQ(again.resolution, device.resolution);
  EXPECT_EQ(again.delay, device.delay);
  EXPECT_EQ(again.workspace_scale, device.workspace_scale);
  EXPECT_EQ(again.clutch_buttons, device.clutch_buttons);
}

TEST(DeviceDescriptionJson, TakesWhatOlderRecordsDoNotHaveAsUnknown) {
  const DeviceDescription old =
      device_description_of(R"({"name": "n", "period": 0.001, "highest_force": 3, "other": []})");
  EXPECT_EQ(old.continuous_force, 0);
  EXPECT_EQ(old.workspace_scale, 1);
}

TEST(DeviceDescriptionJson, SaysWhatIsMissingOrWrong) {
  EXPECT_NE(refusal([] {
              return device_description_of(R"({"name": "n", "period": 1})");
            }).find("highest_force"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              return device_description_of(R"({"name": 3, "period": 1, "highest_force": 1})");
            }).find("description of a device is damaged"),
            std::string::npos);
  EXPECT_NE(refusal([] { return device_description_of("{"); }).find("damaged"), std::string::npos);
}

}  // namespace
}  // namespace palpate::devices
