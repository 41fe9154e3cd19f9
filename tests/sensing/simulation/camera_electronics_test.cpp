// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/camera_electronics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::sensing {
namespace {

cv::Mat evenly_lit(float light) { return {200, 300, CV_32FC3, cv::Scalar::all(light)}; }

VirtualSensor three_chips() {
  VirtualSensor sensor;
  sensor.readout = Readout::color;
  sensor.bits = 16;
  return sensor;
}

TEST(CameraElectronics, MakesShotAndReadNoiseOfTheirLaws) {
  VirtualSensor sensor = three_chips();
  // Few electrons, drawn from Poisson's law, and many; read noise alone would reach below zero.
  for (const double light : {0.02, 0.1, 0.5}) {
    for (const double full_well : {600.0, 12000.0}) {
      sensor.full_well = full_well;
      sensor.read_noise = 0.05 * light * full_well;
      const cv::Mat frame = read_out(evenly_lit(static_cast<float>(light)), 1, sensor, 3);
      cv::Scalar mean, deviation;
      cv::meanStdDev(frame.reshape(1), mean, deviation);
      const double variance =
          (light * full_well + sensor.read_noise * sensor.read_noise) / (full_well * full_well);
      const double count = static_cast<double>(frame.total()) * 3;
      // Five standard deviations of the estimates.
      EXPECT_NEAR(mean[0] / 65535, light, 5 * std::sqrt(variance / count)) << full_well;
      EXPECT_NEAR(deviation[0] * deviation[0] / (65535.0 * 65535) / variance, 1,
                  5 * std::sqrt(3 / count))
          << light << ' ' << full_well;
    }
  }
}

TEST(CameraElectronics, MakesNoiseThatIsFreeOfPatterns) {
  const cv::Mat frame = read_out(evenly_lit(0.5F), 1, three_chips(), 0);
  cv::Mat noise;
  frame.reshape(1).convertTo(noise, CV_64F);
  noise -= cv::mean(noise)[0];
  const double power = noise.dot(noise);
  const double bound = 5 / std::sqrt(static_cast<double>(noise.total()));
  for (const auto& [down, across] : {std::pair{0, 1}, {0, 3}, {1, 0}, {1, 3}, {2, 6}}) {
    const cv::Mat first = noise(cv::Rect(0, 0, noise.cols - across, noise.rows - down));
    const cv::Mat second = noise(cv::Rect(across, down, noise.cols - across, noise.rows - down));
    EXPECT_LT(std::abs(first.dot(second) / power), bound) << down << ' ' << across;
  }
}

TEST(CameraElectronics, DrawsOtherNoiseForAnotherSeed) {
  VirtualSensor sensor = three_chips();
  const cv::Mat one = read_out(evenly_lit(0.5F), 1, sensor, 0);
  EXPECT_EQ(cv::norm(one, read_out(evenly_lit(0.5F), 1, sensor, 0), cv::NORM_INF), 0);
  sensor.seed = 2;
  EXPECT_GT(cv::norm(one, read_out(evenly_lit(0.5F), 1, sensor, 0), cv::NORM_INF), 0);
}

TEST(CameraElectronics, ArrangesColoursAsRggb) {
  VirtualSensor sensor = ideal({});
  sensor.readout = Readout::mosaic;
  const cv::Mat light(4, 6, CV_32FC3, cv::Scalar(0.1, 0.5, 0.9));
  const cv::Mat raw = read_out(light, 1, sensor, 0);
  ASSERT_EQ(raw.type(), CV_16UC1);
  EXPECT_NEAR(raw.at<ushort>(2, 4) / 65535.0, 0.9, 1e-5);
  EXPECT_NEAR(raw.at<ushort>(2, 3) / 65535.0, 0.5, 1e-5);
  EXPECT_NEAR(raw.at<ushort>(1, 4) / 65535.0, 0.5, 1e-5);
  EXPECT_NEAR(raw.at<ushort>(1, 3) / 65535.0, 0.1, 1e-5);
}

TEST(CameraElectronics, InterpolatesLinearLightExactly) {
  VirtualSensor sensor = ideal({});
  sensor.readout = Readout::demosaiced;
  cv::Mat light(20, 24, CV_32FC3);
  light.forEach<cv::Vec3f>([](cv::Vec3f& pixel, const int* at) {
    for (int c = 0; c < 3; ++c) {
      pixel[c] = 0.1F + 0.1F * static_cast<float>(c) + 0.01F * static_cast<float>(at[0]) +
                 0.02F * static_cast<float>(at[1]);
    }
  });
  const cv::Mat frame = read_out(light, 1, sensor, 0);
  for (int row = 1; row < 19; ++row) {
    for (int column = 1; column < 23; ++column) {
      const auto& pixel = frame.at<cv::Vec<ushort, 3>>(row, column);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(pixel[c] / 65535.0, light.at<cv::Vec3f>(row, column)[c], 2e-5);
      }
    }
  }
}

TEST(CameraElectronics, SaturatesAndBendsTheResponse) {
  VirtualSensor sensor = ideal({});
  sensor.bits = 8;
  sensor.camera_gamma = 2.2;
  EXPECT_EQ(read_out(evenly_lit(0.25F), 0.5, sensor, 0).at<cv::Vec3b>(9, 9)[2],
            std::lround(255 * std::pow(0.125, 1 / 2.2)));
  EXPECT_EQ(read_out(evenly_lit(0.25F), 8, sensor, 0).at<cv::Vec3b>(9, 9)[2], 255);
}

TEST(CameraElectronics, ExposesByPercentileOrDistance) {
  VirtualSensor sensor;
  sensor.exposure_percentile = 0.9;
  sensor.exposure_level = 0.5;
  cv::Mat light(1, 101, CV_32FC3, cv::Scalar::all(0));
  PixelMask lit = PixelMask::Constant(1, 101, true);
  for (int i = 0; i <= 100; ++i) light.at<cv::Vec3f>(0, i)[i % 3] = static_cast<float>(100 - i);
  EXPECT_NEAR(choose_exposure(light, lit, sensor), 0.5 / 90, 1e-9);
  lit.leftCols(50).setConstant(false);  // pixels brighter than 50 do not count
  EXPECT_NEAR(choose_exposure(light, lit, sensor), 0.5 / 45, 1e-9);
  lit.setConstant(false);
  EXPECT_EQ(choose_exposure(light, lit, sensor), 1);
  sensor.exposure_distance = 2000;
  EXPECT_EQ(choose_exposure(light, lit, sensor), 2);
}

}  // namespace
}  // namespace palpate::sensing
