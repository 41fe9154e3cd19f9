// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_input.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

namespace palpate::apps {
namespace {

/// A sinusoid of 20 px down the image, as a display with this gamma shows it.
cv::Mat sinusoid(double gamma) {
  cv::Mat image(240, 320, CV_16U);
  for (int row = 0; row < image.rows; ++row) {
    const double value = 0.5 + 0.45 * std::cos(2 * std::numbers::pi * row / 20);
    image.row(row).setTo(60000 * std::pow(value, gamma));
  }
  return image;
}

/// Returns the messages that are logged while the frame is read.
std::string said_of(const cv::Mat& image,
                    void (*change)(sensing::SourceFrame&) = examine_when_read) {
  std::ostringstream text;
  auto& sinks = spdlog::default_logger()->sinks();
  sinks.push_back(std::make_shared<spdlog::sinks::ostream_sink_mt>(text));
  sensing::SourceFrame frame{
      .number = 0, .name = "wave.png", .file = {}, .read = [&] { return image; }};
  change(frame);
  EXPECT_EQ(frame.read().data, image.data);
  sinks.pop_back();
  return text.str();
}

TEST(DecodeInput, ASinusoidWithHarmonicsIsTold) {
  EXPECT_EQ(said_of(sinusoid(1)), "");
  const std::string said = said_of(sinusoid(2.2));
  EXPECT_NE(said.find("wave.png: the sinusoid is distorted (second harmonic 2"), std::string::npos)
      << said;
  EXPECT_EQ(said_of(cv::Mat::zeros(240, 320, CV_16U)), "") << "nothing to examine";
}

TEST(DecodeInput, TwelveBitsInSixteenAreTold) {
  cv::Mat image(4, 4, CV_16UC3, cv::Scalar(100, 2000, 4095));
  EXPECT_NE(said_of(image, doubt_bits_when_read).find("pass --bits 12"), std::string::npos);
  image.at<cv::Vec3w>(0, 0)[0] = 60000;
  EXPECT_EQ(said_of(image, doubt_bits_when_read), "");
  EXPECT_EQ(said_of(cv::Mat(4, 4, CV_8UC3, cv::Scalar::all(9)), doubt_bits_when_read), "");
}

}  // namespace
}  // namespace palpate::apps
