// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_assessment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Seven pixels: none; lit with a good, a bad and no depth; lit and grazing; dark; beyond the
/// image; and one of the second body.
struct Pixels {
  SceneTruth truth{.range = {geometry::ImageF(1, 8), {}},
                   .body = PixelLabels(1, 8),
                   .covered = PixelMask(1, 8),
                   .lit = PixelMask(1, 8),
                   .incidence = geometry::ImageF(1, 8)};
  DecodeResult decoded;

  Pixels() {
    truth.range.z << kUnknown, 500, 500, 510, 500, 500, 500, 900;
    truth.body << -1, 0, 0, 0, 0, 0, 0, 1;
    truth.covered << false, true, true, true, true, true, false, true;
    truth.lit << false, true, true, true, true, false, false, true;
    truth.incidence << kUnknown, 0.2F, 0.2F, 0.2F, 1.3F, 0.2F, 0.2F, 0.2F;
    decoded.range.z.resize(1, 8);
    decoded.range.z << 700, 501, 520, kUnknown, 500.5F, kUnknown, kUnknown, kUnknown;
    decoded.reasons = ReasonImage::Zero(1, 8);
    decoded.reasons(0, 3) = static_cast<std::uint8_t>(Reason::border);
    decoded.reasons(0, 5) = decoded.reasons(0, 6) = static_cast<std::uint8_t>(Reason::unlit);
  }
};

TEST(RigAssessment, CountsWhatBecomesOfPixels) {
  const Pixels pixels;
  const RigAssessment found = assess(pixels.decoded, pixels.truth, {.counted_bodies = 1});
  EXPECT_EQ(found.visible, 6);
  EXPECT_EQ(found.outside, 1);
  EXPECT_EQ(found.dark, 1);
  EXPECT_EQ(found.score.measurable, 4);
  EXPECT_EQ(found.score.covered, 3);
  EXPECT_EQ(found.facing, 3);
  EXPECT_EQ(found.facing_covered, 2);
  EXPECT_EQ(found.score.measured, 4);
  EXPECT_EQ(found.score.wrong, 2);  // 4 % off; a depth where there is no surface
  EXPECT_EQ(found.stray, 1);
  EXPECT_EQ(found.reasons[static_cast<std::size_t>(Reason::border)], 1);
  EXPECT_EQ(found.reasons[static_cast<std::size_t>(Reason::unlit)], 0);  // it is not lit
  EXPECT_EQ(found.score.error.count, 2);
  EXPECT_NEAR(found.score.error.rms, std::sqrt((1 + 0.25) / 2), 1e-6);
  EXPECT_EQ(found.score.distance, 500);
  EXPECT_EQ(assess(pixels.decoded, pixels.truth).visible, 7);
}

TEST(RigAssessment, LeavesOutWhateverSceneryMeasures) {
  Pixels pixels;
  pixels.decoded.range.z(0, 7) = 700;  // 22 % off
  const RigAssessment found = assess(pixels.decoded, pixels.truth, {.counted_bodies = 1});
  EXPECT_EQ(found.score.measured, 4);
  EXPECT_EQ(found.score.wrong, 2);
  EXPECT_TRUE(std::isnan(found.score.difference(0, 7)));
  EXPECT_EQ(assess(pixels.decoded, pixels.truth).score.wrong, 3);
}

TEST(RigAssessment, RefusesOptionsOutOfRangeAndOtherSizes) {
  Pixels pixels;
  EXPECT_THROW((void)assess(pixels.decoded, pixels.truth, {.counted_bodies = 0}), InvalidInput);
  EXPECT_THROW((void)assess(pixels.decoded, pixels.truth, {.max_incidence = 1.6}), InvalidInput);
  pixels.decoded.reasons.resize(1, 7);
  EXPECT_THROW((void)assess(pixels.decoded, pixels.truth), InvalidInput);
}

/// A plane that fills the image.
std::vector<Body> plane_at(double z) {
  Body body;
  body.mesh.vertices.resize(3, 4);
  body.mesh.vertices << -z, z, z, -z, -z, -z, z, z, z, z, z, z;
  body.mesh.triangles.resize(3, 2);
  body.mesh.triangles << 0, 0, 1, 2, 2, 3;
  return {body};
}

cv::Mat draw(const Pattern& pattern, const Rig& rig) {
  cv::Mat panel(rig.projector.height, rig.projector.width, CV_32FC3);
  panel.forEach<cv::Vec3f>([&](cv::Vec3f& pixel, const int* at) {
    std::size_t stripe = 0;
    while (stripe < pattern.stripe_edges.size() && at[1] > pattern.stripe_edges[stripe]) ++stripe;
    const double light =
        pattern.mean +
        pattern.amplitude * std::cos(2 * std::numbers::pi * at[0] / pattern.period + pattern.phase);
    for (int c = 0; c < 3; ++c) {
      const double color =
          pattern.stripes.empty()
              ? 1
              : pattern.colors[static_cast<std::size_t>(pattern.stripes[stripe])].rgb[2 - c];
      pixel[c] = static_cast<float>(color * light);
    }
  });
  return panel;
}

TEST(RigAssessment, FindsThatAGoodRigMeasuresAPlane) {
  const Rig rig = make_rig(false);
  Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const cv::Mat panel = draw(pattern, rig);
  const RigTrial trial = try_rig(rig, pattern, panel, plane_at(700), {});
  ASSERT_TRUE(trial.decoded) << trial.failure;
  EXPECT_EQ(trial.training.size(), 6U);
  const RigAssessment found = assess(*trial.decoded, trial.simulation.truth);
  EXPECT_GT(found.score.coverage, 0.85);
  EXPECT_LT(found.score.relative_error.median, 0.001);
  EXPECT_EQ(found.score.wrong, 0);

  // Without stripes the anchor determines the period.
  pattern.colors.clear();
  pattern.stripes.clear();
  pattern.stripe_edges.clear();
  const RigTrial white = try_rig(rig, pattern, draw(pattern, rig), plane_at(700), {});
  ASSERT_TRUE(white.decoded);
  EXPECT_LT(assess(*white.decoded, white.simulation.truth).score.relative_error.median, 0.001);
}

TEST(RigAssessment, DemosaicsWhatTheDecoderTakes) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const RigTrial trial =
      try_rig(rig, pattern, draw(pattern, rig), plane_at(700), {.readout = Readout::mosaic});
  ASSERT_TRUE(trial.decoded) << trial.failure;
  EXPECT_EQ(trial.simulation.frames[0].channels(), 1);
  EXPECT_EQ(trial.training[0].images[0].channels(), 1);
  const RigAssessment found = assess(*trial.decoded, trial.simulation.truth);
  EXPECT_GT(found.score.coverage, 0.8);
  EXPECT_LT(found.score.relative_error.median, 0.001);
}

TEST(RigAssessment, SaysWhyNothingCanBeMeasured) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const cv::Mat panel = draw(pattern, rig);
  // Nearer than the range in which the two views overlap.
  EXPECT_NE(try_rig(rig, pattern, panel, plane_at(60), {}).failure.find("no light"),
            std::string::npos);
  // A red surface reflects no green.
  std::vector<Body> red = plane_at(700);
  red[0].reflectance = {0.8, 0, 0};
  const RigTrial trial = try_rig(rig, pattern, panel, red, {});
  EXPECT_FALSE(trial.decoded);
  EXPECT_NE(trial.failure.find("G"), std::string::npos) << trial.failure;
}

}  // namespace
}  // namespace palpate::sensing
