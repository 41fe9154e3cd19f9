// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Tests that need no camera: names, messages, the list.
#include "capture/v4l2_camera.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(V4l2Camera, ADeviceThatIsNotThereIsNamed) {
  const std::string message = message_of<InvalidInput>([] { (void)open_camera("v4l2:997"); });
  EXPECT_NE(message.find("v4l2:997: there is no /dev/video997; there "), std::string::npos)
      << message;
}

TEST(V4l2Camera, OnlyNumbersNameADevice) {
  for (const char* name : {"x", "-1", "0x", "1.5", "99999999999999999999"}) {
    const std::string message = message_of<InvalidInput>([&] { (void)open_v4l2_camera(name, {}); });
    EXPECT_NE(message.find("is no number of a device"), std::string::npos) << message;
  }
}

TEST(V4l2Camera, RawMosaicsAreNotOffered) {
  const std::string message =
      message_of<InvalidInput>([] { (void)open_v4l2_camera("997", {.pixel_format = "BayerRG8"}); });
  EXPECT_NE(message.find("through V4L2 images are BGR8"), std::string::npos) << message;
}

TEST(V4l2Camera, TheListHasTheNamesOfTheKernelInTheOrderOfTheNumbers) {
  const ScratchFolder folder;
  for (const char* device : {"video10", "video2", "v4l-subdev0"})
    std::filesystem::create_directory(folder / device);
  write_text(folder / "video2/name", "Grey camera\n");
  write_text(folder / "video10/name", "HDMI in: stick\n");
  const std::vector<CameraEntry> entries = list_v4l2_cameras(folder.path());
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].name, "v4l2:2");
  EXPECT_EQ(entries[0].model, "Grey camera");
  EXPECT_EQ(entries[1].name, "v4l2:10");
  EXPECT_TRUE(list_v4l2_cameras(folder / "nowhere").empty());
}

}  // namespace
}  // namespace palpate::sensing
