// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/depth_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "not_finite.h"
#include "refusal.h"

namespace palpate::geometry {
namespace {

// `count` frames of a floor that recedes from 400 to 1600 mm, with noise and rounding.
std::vector<ImageF> still_frames(const DepthNoise& noise, int count, double resolution = 0) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<ImageF> frames;
  for (int k = 0; k < count; ++k) {
    ImageF z(60, 80);
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const double truth = 400 + 1200 * static_cast<double>(i) / static_cast<double>(z.size());
      double depth = truth + noise.deviation(truth) * normal(random);
      if (resolution > 0) depth = resolution * std::round(depth / resolution);
      z.data()[i] = static_cast<float>(depth);
    }
    frames.push_back(z);
  }
  return frames;
}

void expect_deviations(const DepthNoise& found, const DepthNoise& truth, double share,
                       double resolution = 0) {
  for (const double z : {450.0, 800.0, 1500.0}) {
    const double expected = std::hypot(truth.deviation(z), resolution / std::sqrt(12.0));
    EXPECT_NEAR(found.deviation(z), expected, share * expected) << z;
  }
}

TEST(DepthNoise, IsFoundWhateverItsParts) {
  for (const DepthNoise& truth : {DepthNoise{2, 0}, DepthNoise{0, 2e-6}, DepthNoise{0.5, 1e-6}})
    expect_deviations(depth_noise(still_frames(truth, 6)), truth, 0.06);
}

TEST(DepthNoise, IncludesRounding) {
  const DepthNoise truth{0.4, 1e-6};
  expect_deviations(depth_noise(still_frames(truth, 6, 1), 1), truth, 0.06, 1);
  // Of depths that rounding makes equal, only rounding is left.
  expect_deviations(depth_noise(still_frames({}, 6, 1), 1), {}, 1e-12, 1);
  EXPECT_EQ(depth_noise(still_frames({}, 6)).deviation(1000), 0);
}

TEST(DepthNoise, LeavesOutPixelsThatSeeTwoThings) {
  const DepthNoise truth{1, 0};
  std::vector<ImageF> frames = still_frames(truth, 6);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (Eigen::Index i = 0; i < frames[k].size(); i += 11)
      frames[k].data()[i] += k % 2 == 0 ? 200.0F : 0.0F;
    frames[k](3, 3 + static_cast<int>(k)) = k % 2 == 0 ? kFloatNaN : 0;
  }
  expect_deviations(depth_noise(frames), truth, 0.06);
}

TEST(DepthNoise, ScalesWithTheUnit) {
  std::vector<ImageF> frames = still_frames({0.5, 1e-6}, 5);
  const DepthNoise before = depth_noise(frames);
  for (ImageF& frame : frames) frame *= 4;
  const DepthNoise after = depth_noise(frames);
  EXPECT_NEAR(after.constant, 4 * before.constant, 1e-6 * after.constant);
  EXPECT_NEAR(after.quadratic, before.quadratic / 4, 1e-6 * before.quadratic);
}

TEST(DepthNoise, RefusesFramesOfASceneThatMoves) {
  std::vector<ImageF> frames = still_frames({0.5, 0}, 5);
  EXPECT_EQ(refusal([&] { return depth_noise(std::span(frames).first(3)); }),
            "the noise of a camera needs at least 4 frames of a scene that does not move; there "
            "are 3");
  for (std::size_t k = 0; k < frames.size(); ++k) frames[k] += 4.0F * static_cast<float>(k);
  EXPECT_EQ(refusal([&] { return depth_noise(frames); }),
            "the depths drift from frame to frame; the noise of a camera needs frames of a scene "
            "that does not move");
  frames.back().resize(20, 30);
  EXPECT_EQ(refusal([&] { return depth_noise(frames); }),
            "the frames of the scene that does not move differ in size");
  frames.assign(4, ImageF::Constant(60, 80, kFloatNaN));
  EXPECT_EQ(refusal([&] { return depth_noise(frames); }),
            "only 0 pixels have a depth in all frames of the scene that does not move; at least "
            "100 are needed");
}

TEST(Deviations, AreKnownWhereDepthsAre) {
  ImageF z(1, 3);
  z << 1000, 0, kFloatNaN;
  const ImageF sigma = deviations({.constant = 0.5, .quadratic = 2e-6}, z);
  EXPECT_FLOAT_EQ(sigma(0), 2.5F);
  EXPECT_TRUE(std::isnan(sigma(1)));
  EXPECT_TRUE(std::isnan(sigma(2)));
}

}  // namespace
}  // namespace palpate::geometry
