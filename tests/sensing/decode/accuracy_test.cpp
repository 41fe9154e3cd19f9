// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Depths of a noisy plane against the Cramer-Rao bound (docs/sensing-accuracy.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "palpate/sensing/decode.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr double kFullWell = 12000;  // electrons
constexpr double kReadNoise = 20;
constexpr double kDistance = 700;  // mm
constexpr double kAmbient = 0.02;
constexpr double kReflectance = 0.8;

/// Shot and read noise of a sensor, rounded to 16 bit.
void add_sensor_noise(cv::Mat& frame) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  for (auto& pixel : cv::Mat_<cv::Vec<ushort, 3>>(frame)) {
    for (int channel = 0; channel < 3; ++channel) {
      const double electrons = pixel[channel] / 65535.0 * kFullWell;
      const double seen =
          electrons + std::sqrt(electrons + kReadNoise * kReadNoise) * normal(generator);
      pixel[channel] =
          static_cast<ushort>(std::lround(65535 * std::clamp(seen / kFullWell, 0.0, 1.0)));
    }
  }
}

/// sqrt(2 / N) sigma / A of N pixels, all three channels alike.
double phase_bound(const Pattern& pattern, double pixels) {
  const double mean = kAmbient + kReflectance * pattern.mean;
  const double variance = (mean * kFullWell + kReadNoise * kReadNoise) / (kFullWell * kFullWell);
  return std::sqrt(2 / (3 * pixels) * variance) / (kReflectance * pattern.amplitude);
}

TEST(Accuracy, DepthsOfANoisyPlaneReachTheCramerRaoBound) {
  const Rig rig = make_rig(false);
  Pattern pattern = make_pattern(Axis::y, 10, 1024);
  pattern.colors.clear();
  pattern.stripes.clear();
  pattern.stripe_edges.clear();
  Scene scene = render(rig, pattern, plane({0, 0, 1}, kDistance), kAmbient, kReflectance);
  add_sensor_noise(scene.frame);
  const DecodeResult result =
      Decoder(rig, pattern, {}, {.anchors = {Anchor{160, 120, kDistance}}}).decode(scene.frame);

  // The window: Hann over two periods down, binomial over five pixels across.
  const Eigen::Vector3d t = rig.T_projector_camera.translation();
  const double camera_period =
      pattern.period * rig.camera.fy / rig.projector.fy * (kDistance + t.z()) / kDistance;
  const double pixels = 4 * camera_period / 3 * 256 / 70;
  double errors = 0;
  double scores = 0;
  int count = 0;
  for (int v = 20; v < rig.camera.height - 20; ++v) {
    for (int u = 5; u < rig.camera.width - 5; ++u) {
      const auto error = static_cast<double>(result.range.z(v, u)) - kDistance;
      if (std::isnan(error)) continue;
      const double ray = (v - rig.camera.cy) / rig.camera.fy;
      const double forward = kDistance + t.z();
      const double phase_per_mm = 2 * std::numbers::pi / pattern.period * rig.projector.fy *
                                  std::abs(ray * t.z() - t.y()) / (forward * forward);
      const double bound = phase_bound(pattern, pixels) / phase_per_mm;
      errors += error * error / (bound * bound);
      const double score = error / static_cast<double>(result.sigma(v, u));
      scores += score * score;
      ++count;
    }
  }
  ASSERT_GT(count, 40000);
  EXPECT_LT(std::sqrt(errors / count), 1.1);
  EXPECT_GT(std::sqrt(errors / count), 0.9) << "no estimate is better than the bound";
  EXPECT_NEAR(std::sqrt(scores / count), 1, 0.1);
}

}  // namespace
}  // namespace palpate::sensing
