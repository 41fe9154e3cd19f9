// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// With the two cameras that Aravis simulates: one inside it, and one of GigE Vision, whose packets
// go through the network interface of this computer.
#include <arv.h>
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <thread>

#include "palpate/core/error.h"
#include "palpate/sensing/live_camera.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLong{20000};

/// The next frame; fails after many tries.
CameraFrame frame_of(LiveCamera& camera) {
  for (int tries = 0; tries < 100; ++tries) {
    if (auto frame = camera.next(kLong)) return *frame;
  }
  throw Error("no frame came");
}

TEST(AravisCamera, SendsFramesOfTheSizeAskedForInTheirOrder) {
  const auto camera = open_camera("aravis:Fake_1", {.size = ImageSize{128, 96}, .rate = 200});
  EXPECT_EQ(camera->state().size.width, 128);
  EXPECT_EQ(camera->state().size.height, 96);
  EXPECT_EQ(camera->state().pixel_format, "Mono8");
  EXPECT_NEAR(camera->state().rate, 200, 2);
  EXPECT_TRUE(camera->state().counts_frames);
  camera->start();
  CameraFrame last = frame_of(*camera);
  EXPECT_EQ(last.number, 0U);
  EXPECT_EQ(last.image.size(), cv::Size(128, 96));
  double least = 0, most = 0;
  cv::minMaxLoc(last.image, &least, &most);
  EXPECT_LT(least, most);  // its test pattern
  for (int i = 0; i < 5; ++i) {
    const CameraFrame frame = frame_of(*camera);
    EXPECT_GT(frame.number, last.number);
    EXPECT_GT(frame.time, last.time);
    last = frame;
  }
}

/// Its frames begin with number 65300, to test programs that read them.
TEST(AravisCamera, CountsOnWhereTheCounterOfTheCameraBeginsAgain) {
  const auto camera = open_camera("aravis:Fake_1", {.size = ImageSize{16, 16}, .rate = 1000});
  camera->start();
  std::uint64_t last = frame_of(*camera).number;
  while (last < 300) {
    const std::uint64_t number = frame_of(*camera).number;
    ASSERT_GT(number, last);
    ASSERT_LT(number, last + 3000);
    last = number;
  }
}

TEST(AravisCamera, MosaicsAndColoursAreWhatTheirFormatSays) {
  const auto mosaic = open_camera("aravis:Fake_1", {.pixel_format = "BayerRG8"});
  EXPECT_EQ(mosaic->state().bayer, BayerPattern::rggb);
  mosaic->start();
  EXPECT_EQ(frame_of(*mosaic).image.type(), CV_8UC1);
  const auto color = open_camera("aravis:Fake_1", {.pixel_format = "RGB8"});
  color->start();
  EXPECT_EQ(frame_of(*color).image.type(), CV_8UC3);
  const auto deep = open_camera("aravis:Fake_1", {.pixel_format = "Mono16"});
  deep->start();
  EXPECT_EQ(deep->state().bits, 16);
  EXPECT_EQ(frame_of(*deep).image.type(), CV_16UC1);
}

TEST(AravisCamera, WhatItDoesNotOfferIsRefusedWithWhatItDoes) {
  const auto message = [](const CameraSettings& settings) {
    return message_of<InvalidInput>([&] { (void)open_camera("aravis:Fake_1", settings); });
  };
  EXPECT_NE(
      message({.pixel_format = "BayerRG12"}).find("has no pixel format BayerRG12; it offers "),
      std::string::npos)
      << message({.pixel_format = "BayerRG12"});
  const std::string size = message({.size = ImageSize{100000, 96}});
  EXPECT_NE(size.find("the size is 100000 x 96 px; the camera offers "), std::string::npos) << size;
  const std::string exposure = message({.exposure_us = 1e12});
  EXPECT_NE(exposure.find("the exposure [us] is 1e+12; the camera offers "), std::string::npos)
      << exposure;
}

TEST(AravisCamera, ExposureAndGainAreThoseAskedFor) {
  const auto camera = open_camera("aravis:Fake_1", {.exposure_us = 5000, .gain = 3});
  EXPECT_NEAR(*camera->state().exposure_us, 5000, 50);
  EXPECT_NEAR(*camera->state().gain, 3, 0.1);
  camera->set_exposure(20000);
  EXPECT_NEAR(*camera->state().exposure_us, 20000, 200);
}

TEST(AravisCamera, ANameThatIsNotThereIsRefusedWithThoseThatAre) {
  const std::string message =
      message_of<InvalidInput>([] { (void)open_camera("aravis:Fake_of_nobody"); });
  EXPECT_NE(message.find("aravis:Fake_of_nobody: cannot be opened; there are "), std::string::npos)
      << message;
}

/// A camera of GigE Vision, as long as it exists.
class NetworkCamera {
 public:
  NetworkCamera() : device_(arv_gv_fake_camera_new("127.0.0.1", "PALPATE")) {}
  ~NetworkCamera() {
    if (device_ != nullptr) g_object_unref(device_);
  }
  NetworkCamera(const NetworkCamera&) = delete;
  NetworkCamera& operator=(const NetworkCamera&) = delete;
  [[nodiscard]] bool runs() const {
    return device_ != nullptr && arv_gv_fake_camera_is_running(device_) != 0;
  }

 private:
  ArvGvFakeCamera* device_;
};

TEST(AravisCamera, FramesOfGigEVisionComeThroughTheNetworkAndLostOnesLeaveAGap) {
  const NetworkCamera network;
  if (!network.runs())
    GTEST_SKIP() << "another simulated camera uses the network interface of this computer";
  const auto camera = open_camera("aravis:127.0.0.1", {.size = ImageSize{64, 48}, .rate = 500});
  camera->start();
  CameraFrame last = frame_of(*camera);
  EXPECT_EQ(last.image.size(), cv::Size(64, 48));
  EXPECT_EQ(last.number, 0U);
  std::uint64_t largest_gap = 0;
  for (int tries = 0; largest_gap <= 1 && tries < 100; ++tries) {
    std::this_thread::sleep_for(milliseconds(100));  // longer than its 32 buffers hold
    for (int i = 0; i < 40; ++i) {
      const CameraFrame frame = frame_of(*camera);
      ASSERT_GT(frame.number, last.number);
      ASSERT_GT(frame.time, last.time);
      largest_gap = std::max(largest_gap, frame.number - last.number);
      last = frame;
    }
  }
  EXPECT_GT(largest_gap, 1U);
}

}  // namespace
}  // namespace palpate::sensing
