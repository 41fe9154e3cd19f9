// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/sensing/response.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// Harmonic `k` of f(0.5 + 0.4 cos), relative to the first: the Fourier integral.
double fourier_ratio(const std::function<double(double)>& f, int k) {
  const auto coefficient = [&](int order) {
    double sum = 0;
    constexpr int kSteps = 4096;
    for (int i = 0; i < kSteps; ++i) {
      const double phi = 2 * std::numbers::pi * i / kSteps;
      sum += f(0.5 + 0.4 * std::cos(phi)) * std::cos(order * phi);
    }
    return sum;
  };
  return coefficient(k) / coefficient(1);
}

struct Look {
  double noise = 0.003;
  double bend = 0;     ///< relative change of the frequency over the image
  double texture = 0;  ///< RMS of the reflectance, in blotches of a few px
};

/// A sinusoid of about eleven px that runs down the image, through `curve`.
cv::Mat picture(const std::function<double(double)>& curve, const Look& look = {}) {
  const cv::Size size(200, 240);
  cv::RNG random(5);
  cv::Mat grain(size, CV_32F);
  cv::Mat blotches(size.height / 6 + 1, size.width / 6 + 1, CV_32F);
  random.fill(grain, cv::RNG::NORMAL, 0, look.noise);
  random.fill(blotches, cv::RNG::NORMAL, 1, look.texture);
  cv::Mat image(size, CV_16U);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double phase =
          2 * std::numbers::pi / 11.3 * (y + look.bend * y * y / (2.0 * size.height)) + 0.02 * x;
      const double light = curve(0.5 + 0.4 * std::cos(phase));
      const double value = static_cast<double>(blotches.at<float>(y / 6, x / 6)) * 0.8 * light +
                           0.03 + static_cast<double>(grain.at<float>(y, x));
      image.at<ushort>(y, x) =
          static_cast<ushort>(std::lround(65535 * std::clamp(value, 0.0, 1.0)));
    }
  }
  return image;
}

const auto linear_response = [](double level) { return level; };
const auto gamma22 = [](double level) { return std::pow(level, 2.2); };

TEST(Harmonics, AreThoseOfTheFourierIntegral) {
  for (const double gamma : {0.6, 1.4, 2.2}) {
    const auto curve = [gamma](double level) { return std::pow(level, gamma); };
    const HarmonicCheck check = check_harmonics(picture(curve));
    EXPECT_NEAR(check.second.value().ratio, fourier_ratio(curve, 2), 0.004) << gamma;
    EXPECT_NEAR(check.third.value().ratio, fourier_ratio(curve, 3), 0.004) << gamma;
    EXPECT_TRUE(check.distorted) << gamma;
    EXPECT_LT(check.second.value().deviation, 0.003);
    EXPECT_NEAR(check.period, 11.3, 0.1);
    EXPECT_FALSE(check.along_x);
  }
}

TEST(Harmonics, ChangingFrequencyHidesNothing) {
  const HarmonicCheck check = check_harmonics(picture(gamma22, {.bend = 0.25}));
  EXPECT_NEAR(check.second.value().ratio, fourier_ratio(gamma22, 2), 0.01);
  EXPECT_NEAR(check_harmonics(picture(linear_response, {.bend = 0.25})).second.value().ratio, 0,
              0.005);
}

TEST(Harmonics, NoiseTextureAndSlopesAreNone) {
  for (const Look& look :
       {Look{}, Look{.noise = 0.05}, Look{.noise = 0.01, .bend = 0.2, .texture = 0.08}}) {
    const HarmonicCheck check = check_harmonics(picture(linear_response, look));
    EXPECT_FALSE(check.distorted) << look.noise;
    EXPECT_LT(std::abs(check.second.value().ratio), 0.01);
    EXPECT_LT(std::abs(check.second.value().ratio), 4 * check.second.value().deviation + 0.002);
  }
}

TEST(Harmonics, LinearizingTakesThemAway) {
  std::vector<GreyImage> ramp;
  for (int level = 0; level <= 255; level += 15) {
    const double value = 0.03 + 0.8 * gamma22(level / 255.0);
    ramp.push_back(
        {level / 255.0, cv::Mat(40, 40, CV_16U, cv::Scalar(std::round(65535 * value))), "grey"});
  }
  const cv::Mat frame = picture(gamma22, {.noise = 0.002});
  EXPECT_TRUE(check_harmonics(frame).distorted);
  const HarmonicCheck check = check_harmonics(linearize(frame, calibrate_response(ramp)));
  EXPECT_FALSE(check.distorted);
  EXPECT_NEAR(check.second.value().ratio, 0, 0.005);
  EXPECT_NEAR(check.third.value().ratio, 0, 0.005);
}

/// A sinusoid of any period through `curve`, and the part of it that a colour mosaic leaves: a part
/// of the sinusoid that changes its sign from row to row.
cv::Mat mosaic_picture(double period, double left, const std::function<double(double)>& curve) {
  cv::Mat image(240, 200, CV_16U);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double wave = 0.4 * std::cos(2 * std::numbers::pi * y / period + 0.5);
      const double light = curve(0.5 + wave) + (y % 2 == 0 ? left : -left) * wave;
      image.at<ushort>(y, x) = static_cast<ushort>(std::lround(60000 * light));
    }
  }
  return image;
}

TEST(Harmonics, WhatAColourMosaicLeavesIsNone) {
  constexpr double kLeft = 0.1;
  for (const double period : {5.2, 6.8, 7.2, 7.9, 8.0, 8.1, 9.0, 12.0})
    EXPECT_FALSE(check_harmonics(mosaic_picture(period, kLeft, linear_response)).distorted)
        << period;
}

TEST(Harmonics, AreUnknownWhereAColourMosaicFeignsThem) {
  const HarmonicCheck eight = check_harmonics(mosaic_picture(8, 0, gamma22));
  EXPECT_FALSE(eight.third);
  EXPECT_NEAR(eight.second.value().ratio, fourier_ratio(gamma22, 2), 0.004);
  EXPECT_TRUE(eight.distorted);
  const HarmonicCheck short_one = check_harmonics(mosaic_picture(5.2, 0, gamma22));
  EXPECT_FALSE(short_one.third) << "fewer than two px a period";
  EXPECT_NEAR(short_one.second.value().ratio, fourier_ratio(gamma22, 2), 0.004);
  const auto at_six = [] { (void)check_harmonics(mosaic_picture(6, 0, gamma22)); };
  EXPECT_NE(message_of<InvalidInput>(at_six).find("another period"), std::string::npos);
}

TEST(Harmonics, TurnWithTheImage) {
  cv::Mat turned;
  cv::transpose(picture(gamma22), turned);
  const HarmonicCheck check = check_harmonics(turned);
  EXPECT_TRUE(check.along_x);
  EXPECT_EQ(check.second.value().ratio, check_harmonics(picture(gamma22)).second.value().ratio);
}

TEST(Harmonics, PredictTheWaveOfADemodulator) {
  // The demodulator itself, on lines of one frequency each: a Hann window of two median periods.
  constexpr int kLines = 400;
  constexpr double kMedianPeriod = 11.3;
  double mean = 0;
  for (int i = 0; i < 64; ++i)
    mean += gamma22(0.5 + 0.4 * std::cos(2 * std::numbers::pi * i / 64)) / 64;
  double squares = 0;
  double count = 0;
  cv::Mat image(kLines, 300, CV_16U);
  for (int y = 0; y < kLines; ++y) {
    const double frequency = (0.85 + 0.3 * (y + 0.5) / kLines) / kMedianPeriod;
    const double start = 0.7 * y * y;  // no pattern down the image
    const auto value = [&](double x) {
      return gamma22(0.5 + 0.4 * std::cos(2 * std::numbers::pi * frequency * x + start));
    };
    for (int x = 0; x < image.cols; ++x)
      image.at<ushort>(y, x) = static_cast<ushort>(std::lround(60000 * value(x)));
    if (y % 10 != 0) continue;
    constexpr double kStep = 0.1;  // px: the integral
    for (double x = 100; x < 100 + 5 * kMedianPeriod; x += 0.37) {
      std::complex<double> sum = 0;
      for (double k = -kMedianPeriod; k <= kMedianPeriod; k += kStep) {
        const double weight = 0.5 + 0.5 * std::cos(std::numbers::pi * k / kMedianPeriod);
        sum += weight * value(x + k) *
               std::polar(1.0, -2 * std::numbers::pi * (x + k) / kMedianPeriod);
      }
      // Effect of the window on the fundamental alone, and on the mean, which the check leaves
      // out.
      std::complex<double> pure = 0;
      std::complex<double> level = 0;
      for (double k = -kMedianPeriod; k <= kMedianPeriod; k += kStep) {
        const std::complex<double> weight =
            (0.5 + 0.5 * std::cos(std::numbers::pi * k / kMedianPeriod)) *
            std::polar(1.0, -2 * std::numbers::pi * (x + k) / kMedianPeriod);
        pure += weight * std::cos(2 * std::numbers::pi * frequency * (x + k) + start);
        level += weight * mean;
      }
      const double wave = std::arg((sum - level) / pure);
      squares += wave * wave;
      count += 1;
    }
  }
  const HarmonicCheck check = check_harmonics(image);
  const double measured = std::sqrt(squares / count);
  EXPECT_GT(measured, 0.005) << "the test shows a wave";
  EXPECT_NEAR(check.phase_wave, measured, 0.2 * measured);
}

TEST(Harmonics, DepthPerRadianIsTheSlopeOfTheTriangulation) {
  const Rig parallel = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, 10, 1024);
  // z^2 p / (2 pi f b) for parallel axes; the baseline along y is 165 mm, the projector 20 mm
  // ahead.
  Rig level = parallel;
  level.T_projector_camera.translation().z() = 0;
  EXPECT_NEAR(depth_per_radian(level, pattern, 800),
              800 * 800 * 10 / (2 * std::numbers::pi * 1500 * 165), 1e-9);
  const Rig verging = make_rig(true);
  const Eigen::Vector2d ray = geometry::undistort(verging.camera, {159.5, 119.5});
  const auto row = [&](double z) {
    const Eigen::Vector3d point = verging.T_projector_camera * (z * ray.homogeneous());
    return verging.projector.fy * point.y() / point.z();
  };
  const double slope = (row(800.01) - row(799.99)) / 0.02;
  EXPECT_NEAR(depth_per_radian(verging, pattern, 800),
              10 / (2 * std::numbers::pi * std::abs(slope)), 1e-5);
  EXPECT_THROW((void)depth_per_radian(level, pattern, std::nan("")), InvalidInput);
}

TEST(Harmonics, RefuseWhatShowsNoSinusoid) {
  const cv::Mat flat(200, 200, CV_8U, cv::Scalar(90));
  EXPECT_NE(message_of<InvalidInput>([&] { (void)check_harmonics(flat); }).find("white sinusoid"),
            std::string::npos);
  cv::Mat noise(200, 200, CV_8U);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 255);
  EXPECT_THROW((void)check_harmonics(noise), InvalidInput);
  EXPECT_THROW((void)check_harmonics(cv::Mat(200, 200, CV_32F)), InvalidInput);
  EXPECT_THROW((void)check_harmonics({}), InvalidInput);
  EXPECT_THROW((void)check_harmonics(picture(linear_response), {.max_ratio = 0}), InvalidInput);
  EXPECT_THROW((void)check_harmonics(picture(linear_response), {.max_misfit = std::nan("")}),
               InvalidInput);
  EXPECT_THROW((void)check_harmonics(picture([](double) { return 2.0; })), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
