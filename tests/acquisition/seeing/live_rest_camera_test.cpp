// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/live_rest_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "palpate/core/error.h"
#include "refusal.h"
#include "throws_message.h"

namespace palpate::acquisition {
namespace {

using ::testing::HasSubstr;

constexpr int kWaiting = 3;  // frames in the buffer of the camera

/// Frame i has the value i everywhere. The first frames wait in a buffer.
class CountingCamera final : public sensing::LiveCamera {
 public:
  explicit CountingCamera(int type, int most = 200) : type_(type), most_(most) {
    state_.name = "counting";
  }
  [[nodiscard]] const sensing::CameraState& state() const override { return state_; }
  void set_exposure(double) override {}
  void start() override { started_ = true; }
  [[nodiscard]] std::optional<sensing::CameraFrame> next(std::chrono::milliseconds wait) override {
    EXPECT_TRUE(started_);
    if (sent_ >= most_ || (wait.count() == 0 && sent_ >= kWaiting)) return std::nullopt;
    const cv::Mat image(4, 6, type_, cv::Scalar::all(added + sent_));
    return sensing::CameraFrame{.image = image, .number = static_cast<std::uint64_t>(sent_++)};
  }
  sensing::CameraState& settings() { return state_; }
  double added = 0;  ///< to the values

 private:
  sensing::CameraState state_;
  int type_, most_;
  int sent_ = 0;
  bool started_ = false;
};

cv::Mat look(std::unique_ptr<CountingCamera> camera, int frames, double patience = 1) {
  return make_live_rest_camera(std::move(camera), patience)->look({.frames = frames}).frame;
}

TEST(LiveRestCamera, ShowsNothingThatWasExposedBefore) {
  const cv::Mat seen = look(std::make_unique<CountingCamera>(CV_8UC3), 1);
  EXPECT_EQ(seen.type(), CV_8UC3);
  // Those that waited, and one whose exposure may have begun before.
  EXPECT_EQ(cv::norm(seen, cv::Mat(4, 6, CV_8UC3, cv::Scalar::all(kWaiting + 1)), cv::NORM_INF), 0);
}

TEST(LiveRestCamera, AveragesConsecutiveFrames) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    auto camera = std::make_unique<CountingCamera>(type);
    if (CV_MAT_DEPTH(type) == CV_16U) camera->settings().bits = 16;
    const cv::Mat seen = look(std::move(camera), 4);
    ASSERT_EQ(seen.type(), CV_MAKETYPE(CV_16U, CV_MAT_CN(type)));
    const double full_scale = CV_MAT_DEPTH(type) == CV_8U ? 255 : 65535;
    const double mean = kWaiting + 1 + 1.5;  // of four consecutive numbers
    EXPECT_LE(cv::norm(seen, cv::Mat(4, 6, seen.type(), cv::Scalar::all(mean * 65535 / full_scale)),
                       cv::NORM_INF),
              0.5)
        << type;
  }
}

TEST(LiveRestCamera, AMosaicBecomesColour) {
  auto camera = std::make_unique<CountingCamera>(CV_8UC1);
  camera->settings().bayer = sensing::BayerPattern::rggb;
  EXPECT_EQ(look(std::move(camera), 1).type(), CV_8UC3);
}

TEST(LiveRestCamera, ACameraThatFallsSilentIsNamed) {
  const auto silent = [](int after, int frames) {
    return look(std::make_unique<CountingCamera>(CV_8UC3, after), frames, 0.01);
  };
  EXPECT_THROWS_MESSAGE((void)silent(0, 1), DeviceError, "counting: sent no frame");
  EXPECT_THROWS_MESSAGE((void)silent(kWaiting + 3, 4), DeviceError, "for 0.01 s");
}

TEST(LiveRestCamera, AFrameWithMoreBitsThanStatedIsAFaultOfTheDevice) {
  auto camera = std::make_unique<CountingCamera>(CV_16UC1);
  camera->settings().bits = 10;
  camera->added = 1024;
  EXPECT_THROWS_MESSAGE((void)look(std::move(camera), 1), DeviceError,
                        "counting: a frame holds the value 1028");
}

TEST(LiveRestCamera, RefusesAPatienceThatIsNoTime) {
  EXPECT_THAT(refusal([] { return look(std::make_unique<CountingCamera>(CV_8UC3), 1, 0); }),
              HasSubstr("patience"));
}

}  // namespace
}  // namespace palpate::acquisition
