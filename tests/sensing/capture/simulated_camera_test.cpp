// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/simulated_camera.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/sensing/tiff_frame.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using std::chrono::milliseconds;

cv::Mat filled(int value, int type = CV_8UC3) { return {4, 6, type, cv::Scalar::all(value)}; }

class SimulatedCameraTest : public ::testing::Test {
 protected:
  SimulatedCamera camera(CameraSettings settings = {.rate = 100}) {
    return {"simulated:x", {filled(0), filled(1), filled(2)}, settings, clock};
  }
  double now = 50;
  CameraClock clock{.now = [this] { return now; },
                    .wait_until = [this](double time) { now = std::max(now, time); }};
};

TEST_F(SimulatedCameraTest, SendsItsImagesAgainAndAgainInTheRhythmOfTheClock) {
  SimulatedCamera simulated = camera();
  simulated.start();
  for (std::uint64_t i = 0; i < 7; ++i) {
    const auto frame = simulated.next(milliseconds(100));
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->number, i);
    EXPECT_EQ(frame->image.at<cv::Vec3b>(0, 0)[0], i % 3);
    EXPECT_NEAR(frame->time, 0.01 * static_cast<double>(i), 1e-12);
    EXPECT_NEAR(now, 50 + 0.01 * static_cast<double>(i + 1), 1e-9);
  }
}

TEST_F(SimulatedCameraTest, NothingIsThereBeforeTheFrameIsDue) {
  SimulatedCamera simulated = camera({.rate = 2});
  simulated.start();
  EXPECT_FALSE(simulated.next(milliseconds(100)));
  EXPECT_NEAR(now, 50.1, 1e-9);
  EXPECT_TRUE(simulated.next(milliseconds(500)));
  EXPECT_NEAR(now, 50.5, 1e-9);
}

TEST_F(SimulatedCameraTest, ALateReaderFindsTheLastFourAndAGap) {
  SimulatedCamera simulated = camera();
  simulated.start();
  EXPECT_EQ(simulated.next(milliseconds(100))->number, 0U);
  now += 0.1005;  // ten frames
  for (const std::uint64_t number : {7U, 8U, 9U, 10U, 11U})
    EXPECT_EQ(simulated.next(milliseconds(100))->number, number);
}

TEST_F(SimulatedCameraTest, SaysWhatItsImagesAre) {
  EXPECT_EQ(camera().state().size.width, 6);
  EXPECT_EQ(camera().state().pixel_format, "BGR8");
  EXPECT_EQ(camera({}).state().rate, 30);
  const SimulatedCamera mosaic("m", {filled(9, CV_16UC1)}, {.pixel_format = "BayerGR12"}, clock);
  EXPECT_EQ(mosaic.state().bayer, BayerPattern::grbg);
  EXPECT_EQ(mosaic.state().bits, 12);
}

TEST_F(SimulatedCameraTest, RefusesWhatItsImagesAreNot) {
  const auto message = [&](const std::vector<cv::Mat>& images, const CameraSettings& settings) {
    return message_of<InvalidInput>(
        [&] { const SimulatedCamera refused("simulated:x", images, settings, clock); });
  };
  EXPECT_NE(message({filled(0)}, {.size = ImageSize{8, 4}}).find("6 x 4 px"), std::string::npos);
  EXPECT_NE(message({filled(0)}, {.pixel_format = "BayerRG8"}).find("BGR8; they are not BayerRG8"),
            std::string::npos);
  EXPECT_NE(message({filled(0), filled(0, CV_8UC1)}, {}).find("same size and type"),
            std::string::npos);
  EXPECT_NE(message({}, {}).find("no image"), std::string::npos);
}

TEST(OpenCamera, PlaysAFolderOfImages) {
  const ScratchFolder folder;
  for (int i = 0; i < 3; ++i)
    write_tiff(folder / (std::to_string(i) + ".tiff"), filled(10 * i, CV_8UC1));
  const auto camera = open_camera("simulated:" + folder.path().string(), {.rate = 1000});
  EXPECT_EQ(camera->state().pixel_format, "Mono8");
  camera->start();
  const auto frame = camera->next(milliseconds(1000));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.at<unsigned char>(0), 10 * (frame->number % 3));
}

TEST(OpenCamera, NamesThatAreNoCameraAreRefusedWithTheKindsThereAre) {
  for (const char* name : {"", "camera", "usb:1", "aravis:", "v4l2:"}) {
    const std::string message = message_of<InvalidInput>([&] { (void)open_camera(name); });
    EXPECT_NE(message.find("it must be aravis:NAME, v4l2:NUMBER or simulated:PATH"),
              std::string::npos)
        << message;
  }
  EXPECT_NE(
      message_of<FileError>([] { (void)open_camera("simulated:/no/where"); }).find("/no/where"),
      std::string::npos);
  EXPECT_NE(message_of<InvalidInput>([] {
              (void)open_camera("simulated:x", {.rate = 0});
            }).find("CameraSettings::rate is 0"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
