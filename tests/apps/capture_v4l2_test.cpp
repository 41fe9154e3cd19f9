// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Recording with a camera of V4L2, which simulated_v4l2.cpp simulates below OpenCV.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "palpate/sensing/frame.h"
#include "run_palpate.h"
#include "simulated_v4l2.h"

namespace palpate::apps {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class CaptureV4l2 : public ::testing::Test {
 protected:
  CommandResult sequence(std::vector<std::string> more, std::vector<std::string> environment = {}) {
    more.insert(more.begin(), {"capture", "sequence", "v4l2:97"});
    more.insert(more.end(), {"-o", scratch / "frames", "--json"});
    environment.push_back(camera());
    return run_palpate(more, {.environment = environment});
  }
  /// The environment variable that loads the simulated camera below OpenCV.
  std::string camera() const {
    // The loader parts its list at spaces, which the path of the build may contain.
    const std::filesystem::path library = scratch / "camera.so";
    if (!exists(library)) create_symlink(PALPATE_SIMULATED_V4L2, library);
    return "LD_PRELOAD=" + library.string();
  }
  /// The numbers of the frames in times.csv.
  std::vector<std::uint64_t> numbers() const {
    std::istringstream table(read_text(scratch / "frames/times.csv"));
    std::string line;
    std::getline(table, line);
    std::vector<std::uint64_t> numbers;
    while (std::getline(table, line))
      numbers.push_back(std::stoull(line.substr(line.find(',') + 1)));
    return numbers;
  }

  ScratchFolder scratch;
};

TEST_F(CaptureV4l2, WritesTheFramesOfTheCameraBitForBit) {
  const CommandResult done =
      sequence({"--size", "320", "240", "--rate", "20", "--exposure", "4000", "--count", "5"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json figures = json::parse(done.out);
  EXPECT_EQ(figures["frames"], 5);
  EXPECT_EQ(figures["camera"]["camera_size"], (json{320, 240}));
  EXPECT_EQ(figures["camera"]["exposure_us"], 4000);
  EXPECT_EQ(figures["camera"]["counts_frames"], false);
  const std::vector<std::uint64_t> number = numbers();
  ASSERT_EQ(number.size(), 5U);
  const cv::Mat first = sensing::read_frame(scratch / "frames/frame_000000.tiff");
  ASSERT_EQ(first.size(), cv::Size(320, 240));
  // The camera may have sent frames before the first that is fetched.
  const auto begin = static_cast<std::uint8_t>(first.at<cv::Vec3b>(0, 0)[0]);
  for (int i = 0; i < 5; ++i) {
    const cv::Mat frame =
        sensing::read_frame(scratch / ("frames/frame_00000" + std::to_string(i) + ".tiff"));
    const std::uint64_t since = number[static_cast<std::size_t>(i)] - number[0];
    for (int row = 0; row < frame.rows; ++row) {
      for (int column = 0; column < frame.cols; ++column) {
        for (int channel = 0; channel < 3; ++channel)
          ASSERT_EQ(frame.at<cv::Vec3b>(row, column)[channel],
                    static_cast<std::uint8_t>(
                        begin + simulated_value(since, static_cast<std::uint32_t>(row),
                                                static_cast<std::uint32_t>(column),
                                                static_cast<std::uint32_t>(channel))))
              << i << ": " << row << ", " << column;
      }
    }
  }
}

TEST_F(CaptureV4l2, AFrameThatTheCameraLostIsCountedByItsTime) {
  const CommandResult done = sequence({"--size", "64", "48", "--rate", "10", "--count", "20"},
                                      {"SIMULATED_V4L2_LOSES=12"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json figures = json::parse(done.out);
  EXPECT_GE(figures["frames_lost"], 1);
  EXPECT_EQ(numbers().back() - numbers().front(), 19 + figures["frames_lost"].get<std::uint64_t>());
}

TEST_F(CaptureV4l2, ACameraThatIsUnpluggedEndsTheRecordingAndWhatThereIsStays) {
  const CommandResult done =
      sequence({"--size", "64", "48", "--rate", "20"}, {"SIMULATED_V4L2_UNPLUGGED=25"});
  EXPECT_EQ(done.status, kWorkFailed);
  EXPECT_THAT(done.err, HasSubstr("no longer sends frames; it may be unplugged"));
  EXPECT_GE(json::parse(done.out)["frames"], 1);
  EXPECT_FALSE(sensing::read_frame(scratch / "frames/frame_000000.tiff").empty());
}

TEST_F(CaptureV4l2, ColoursAtHalfTheResolutionAreWarnedOf) {
  const CommandResult done =
      sequence({"--size", "64", "48", "--rate", "20", "--count", "1"}, {"SIMULATED_V4L2_YUYV=1"});
  ASSERT_EQ(done.status, kDone) << done.err;
  EXPECT_THAT(done.err, HasSubstr("v4l2:97: sends colours at half the resolution (YUYV)"));
  const cv::Mat frame = sensing::read_frame(scratch / "frames/frame_000000.tiff");
  ASSERT_EQ(frame.type(), CV_8UC3);
  std::vector<cv::Mat> channels;
  cv::split(frame, channels);
  EXPECT_EQ(cv::norm(channels[0], channels[2], cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(channels[0], cv::NORM_INF), 100);
}

TEST_F(CaptureV4l2, StillsAreTakenOneForEachImageThatIsShown) {
  ASSERT_EQ(run_palpate(
                {"pattern", "--size", "320", "240", "--grey-steps", "3", "-o", scratch / "pattern"})
                .status,
            kDone);
  const CommandResult done = run_palpate(
      {"capture", "training", "v4l2:97", "--size", "64", "48", "--rate", "60", "--by-hand",
       "--show", scratch / "pattern", "-o", scratch / "training", "--json"},
      {.answers = std::string(100, '\n'), .environment = {camera()}});
  ASSERT_EQ(done.status, kDone) << done.err;
  std::size_t images = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scratch / "training")) {
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "pattern" / entry.path().filename()));
    EXPECT_EQ(sensing::read_frame(entry.path()).size(), cv::Size(64, 48));
    ++images;
  }
  EXPECT_EQ(json::parse(done.out)["images"], images);
  EXPECT_GT(images, 10U);
}

TEST_F(CaptureV4l2, WhatTheCameraDoesNotOfferIsRefusedWithTheNearest) {
  const auto refused = [&](const std::vector<std::string>& call) {
    const CommandResult done = sequence(call);
    EXPECT_EQ(done.status, kWrongCall);
    return done.err;
  };
  EXPECT_THAT(refused({"--size", "1280", "720"}), HasSubstr("the nearest is 640"));
  EXPECT_THAT(refused({"--rate", "200"}), HasSubstr("the rate [frames/s] 200; the nearest is 60"));
  EXPECT_THAT(refused({"--exposure", "90000"}), HasSubstr("the nearest is 300"));
  EXPECT_THAT(refused({"--gain", "3"}), HasSubstr("does not offer the gain 3"));
}

}  // namespace
}  // namespace palpate::apps
