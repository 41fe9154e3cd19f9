// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/bayer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

const std::map<std::string, BayerPattern> kPatterns = {{"rggb", BayerPattern::rggb},
                                                       {"bggr", BayerPattern::bggr},
                                                       {"grbg", BayerPattern::grbg},
                                                       {"gbrg", BayerPattern::gbrg}};

/// Mosaic of a BGR image by a camera with the filters `name` (of a row of two, then the next).
template <typename Sample>
cv::Mat mosaic_of(const cv::Mat& bgr, const std::string& name) {
  cv::Mat mosaic(bgr.rows, bgr.cols, CV_MAKETYPE(bgr.depth(), 1));
  for (int v = 0; v < bgr.rows; ++v) {
    for (int u = 0; u < bgr.cols; ++u) {
      const char color = name[static_cast<std::size_t>(2 * (v % 2) + u % 2)];
      const int channel = color == 'b' ? 0 : color == 'g' ? 1 : 2;
      mosaic.at<Sample>(v, u) = bgr.at<cv::Vec<Sample, 3>>(v, u)[channel];
    }
  }
  return mosaic;
}

TEST(Bayer, GivesBackAnImageOfOneColour) {
  const cv::Mat narrow(20, 30, CV_8UC3, cv::Scalar(10, 100, 200));
  const cv::Mat wide(21, 31, CV_16UC3, cv::Scalar(1000, 20000, 60000));
  for (const auto& [name, pattern] : kPatterns) {
    EXPECT_EQ(bayer_pattern(name), pattern);
    EXPECT_EQ(
        cv::norm(demosaic(mosaic_of<std::uint8_t>(narrow, name), pattern), narrow, cv::NORM_INF), 0)
        << name;
    EXPECT_EQ(cv::norm(demosaic(mosaic_of<std::uint16_t>(wide, name), pattern), wide, cv::NORM_INF),
              0)
        << name;
  }
}

TEST(Bayer, KeepsWhatEachPixelHasSeen) {
  cv::Mat image(24, 32, CV_16UC3);
  cv::randu(image, 0, 65535);
  for (const auto& [name, pattern] : kPatterns) {
    const cv::Mat mosaic = mosaic_of<std::uint16_t>(image, name);
    const cv::Mat again = mosaic_of<std::uint16_t>(demosaic(mosaic, pattern), name);
    const cv::Rect inside(1, 1, image.cols - 2, image.rows - 2);
    EXPECT_EQ(cv::norm(mosaic(inside), again(inside), cv::NORM_INF), 0) << name;
  }
}

/// Phase of a wave of `period` px down the image in one channel, over whole periods.
double phase(const cv::Mat& image, int channel, int period) {
  std::complex<double> sum = 0;
  for (int v = 2 * period; v < 8 * period; ++v) {
    for (int u = 4; u < image.cols - 4; ++u) {
      sum += static_cast<double>(image.at<cv::Vec<ushort, 3>>(v, u)[channel]) *
             std::polar(1.0, -2 * std::numbers::pi * v / period);
    }
  }
  return std::arg(sum);
}

TEST(Bayer, LeavesThePhaseOfASinusoidWhereItWas) {
  constexpr int kPeriod = 7;  // px, as in the frames of a projector; sampled every 2 px in red
  constexpr double kPhase = 0.4;
  cv::Mat image(10 * kPeriod, 40, CV_16UC3);
  for (int v = 0; v < image.rows; ++v) {
    const double value = 32000 + 20000 * std::cos(2 * std::numbers::pi * v / kPeriod + kPhase);
    image.row(v) = cv::Scalar(value, value, value);
  }
  for (const auto& [name, pattern] : kPatterns) {
    const cv::Mat again = demosaic(mosaic_of<ushort>(image, name), pattern);
    for (const int channel : {0, 1, 2}) {
      // Only rounding of the samples is left: 1 of 20000, over many pixels.
      EXPECT_NEAR(phase(again, channel, kPeriod), kPhase, 1e-4) << name << " " << channel;
    }
  }
}

TEST(Bayer, RefusesWhatIsNoMosaic) {
  const auto refusal = [](const cv::Mat& image) {
    return message_of<InvalidInput>([&] { (void)demosaic(image, BayerPattern::rggb); });
  };
  EXPECT_NE(refusal(cv::Mat(8, 8, CV_8UC3, cv::Scalar())).find("has 3 channels"),
            std::string::npos);
  EXPECT_NE(refusal(cv::Mat(8, 8, CV_32FC1, cv::Scalar())).find("8 or 16 bit"), std::string::npos);
  EXPECT_NE(refusal(cv::Mat(2, 8, CV_8UC1, cv::Scalar())).find("at least 3 x 3"),
            std::string::npos);
  EXPECT_NE(message_of<InvalidInput>([] { (void)bayer_pattern("rgbg"); }).find("rgbg"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
