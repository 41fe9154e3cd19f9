// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/sensing/pattern_design.h"
#include "phase/chromatic.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// Half a level of 16 bit.
constexpr double kLevel = 0.5 / 65535 + 1e-12;

double rgb_value(const cv::Mat& image, double v, double u, int channel) {
  return image.at<cv::Vec3w>(static_cast<int>(v), static_cast<int>(u))[2 - channel] / 65535.0;
}

double sinusoid(const Pattern& pattern, double pixel) {
  return pattern.mean + pattern.amplitude *
                            std::cos(2 * std::numbers::pi * pixel / pattern.period + pattern.phase);
}

/// A small rig with everything: rotation, both lenses distorted, chromatic values.
Rig small_distorted_rig() {
  Rig rig = make_rig(true);
  rig.projector = {.width = 200, .height = 150, .fx = 290, .fy = 295, .cx = 101, .cy = 73};
  rig.projector.distortion = {-0.12, 0.05, 0.002, -0.001, 0.01};
  rig.red = {.alpha = 0.998, .beta = 1.004, .gamma = 0.003};
  rig.blue = {.alpha = 1.001, .beta = 0.995, .gamma = -0.002};
  return rig;
}

TEST(PatternImage, ShowsShiftedSinusoidsAndThenACodeThatNumbersHalfPeriods) {
  for (const Axis axis : {Axis::y, Axis::x}) {
    const Pattern single{.axis = axis, .period = 9.5, .phase = 0.7, .mean = 0.5, .amplitude = 0.4};
    const Pattern pattern = multishot_pattern(single, 5, {160, 120});
    const std::vector<cv::Mat> images = draw_multishot(pattern, 160, 120, 16);
    const int length = axis == Axis::x ? 160 : 120;
    ASSERT_EQ(images.size(), 5U + static_cast<unsigned>(std::ceil(std::log2(length / 4.75))));
    unsigned last = 0;
    for (int p = 0; p < length; ++p) {
      const int u = axis == Axis::x ? p : 3;
      const int v = axis == Axis::x ? 3 : p;
      for (std::size_t k = 0; k < 5; ++k) {
        Pattern shifted = pattern;
        shifted.phase += 2 * std::numbers::pi * static_cast<double>(k) / 5;
        for (int channel = 0; channel < 3; ++channel)
          ASSERT_NEAR(rgb_value(images[k], v, u, channel), sinusoid(shifted, p), kLevel);
      }
      unsigned number = 0;  // each bit of a reflected code is the sum of the bits above
      unsigned above = 0;
      for (std::size_t k = 5; k < images.size(); ++k) {
        const double value = rgb_value(images[k], v, u, 1);
        ASSERT_TRUE(std::abs(value - 0.1) < kLevel || std::abs(value - 0.9) < kLevel);
        above ^= value > 0.5 ? 1U : 0U;
        number = 2 * number + above;
      }
      ASSERT_EQ(number, static_cast<unsigned>((p + 0.5) / 4.75));
      ASSERT_LE(number - last, 1U);
      last = number;
    }
  }
  EXPECT_THROW((void)draw_multishot({.period = 9.5}, 160, 120), InvalidInput);
}

TEST(PatternImage, RectifiesTheImagesOfAStillSceneAsItDoesOne) {
  const Rig rig = small_distorted_rig();
  const DrawOptions options{.rectify = true};
  const geometry::Camera panel = rig_of_drawing(rig, options).projector;
  const Pattern pattern =
      multishot_pattern({.axis = Axis::y, .period = 60}, 3, {panel.width, panel.height});
  Pattern first = pattern;
  first.multishot.reset();
  const std::vector<cv::Mat> images = draw_multishot(pattern, rig, options);
  EXPECT_EQ(cv::norm(images[0], draw_pattern(first, rig, options), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(images[1], images[0], cv::NORM_INF), 0);
}

TEST(PatternImage, ShowsTheSinusoidAtPixelCentresAndHardStripes) {
  for (const Axis axis : {Axis::y, Axis::x}) {
    const int width = 320;
    const int height = 240;
    PatternOptions options{.axis = axis, .period = 9.5};
    Pattern pattern = design_pattern(width, height, options).pattern;
    pattern.phase = 0.7;
    const cv::Mat image = draw_pattern(pattern, width, height, 16);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const int along = axis == Axis::x ? u : v;
        const int across = axis == Axis::x ? v : u;
        std::size_t stripe = 0;
        while (stripe < pattern.stripe_edges.size() && pattern.stripe_edges[stripe] < across)
          ++stripe;
        const Eigen::Vector3d rgb =
            pattern.colors[static_cast<std::size_t>(pattern.stripes[stripe])].rgb;
        for (int channel = 0; channel < 3; ++channel) {
          ASSERT_NEAR(rgb_value(image, v, u, channel), rgb[channel] * sinusoid(pattern, along),
                      kLevel);
        }
      }
    }
  }
}

TEST(PatternImage, MixesTheColoursOfAnEdgeWithinAPixel) {
  const Pattern pattern{.colors = {{"R", {1, 0, 0}}, {"C", {0, 1, 1}}},
                        .stripes = {0, 1},
                        .stripe_edges = {3.2},
                        .period = 10,
                        .mean = 0.9,
                        .amplitude = 0.1};
  const cv::Mat image = draw_pattern(pattern, 8, 4, 16);
  const double brightness = sinusoid(pattern, 0);
  EXPECT_NEAR(rgb_value(image, 0, 2, 0), brightness, kLevel);
  EXPECT_NEAR(rgb_value(image, 0, 3, 0), 0.7 * brightness, kLevel);
  EXPECT_NEAR(rgb_value(image, 0, 3, 1), 0.3 * brightness, kLevel);
  EXPECT_NEAR(rgb_value(image, 0, 4, 1), brightness, kLevel);
}

TEST(PatternImage, HasEightOrSixteenBits) {
  const Pattern pattern = design_pattern(320, 240).pattern;
  const cv::Mat coarse = draw_pattern(pattern, 320, 240, 8);
  const cv::Mat fine = draw_pattern(pattern, 320, 240, 16);
  ASSERT_EQ(coarse.type(), CV_8UC3);
  ASSERT_EQ(fine.type(), CV_16UC3);
  for (int v = 0; v < 240; ++v) {
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(coarse.at<cv::Vec3b>(v, 7)[channel] / 255.0, rgb_value(fine, v, 7, 2 - channel),
                  0.5 / 255 + kLevel);
    }
  }
}

// Green's light from a straight drawing: a point lit by a panel pixel has, seen by the rig it is
// decoded with, that pixel's phase.
TEST(PatternImage, StraightOnThePanelAPointHasThePhaseOfThePixelThatLightsIt) {
  const Rig rig = small_distorted_rig();
  const Pattern pattern{.axis = Axis::y, .period = 11};
  const cv::Mat image = draw_pattern(pattern, rig, {.bits = 16});
  const Rig drawn = rig_of_drawing(rig);
  for (const Eigen::Vector2d& panel : {Eigen::Vector2d(20, 15), {103, 70}, {185, 140}}) {
    const Eigen::Vector3d ray = geometry::undistort(rig.projector, panel).homogeneous();
    const Eigen::Vector3d point = rig.T_projector_camera.inverse() * (700 * ray);
    const Eigen::Vector2d pixel =
        geometry::distort(drawn.projector, (drawn.T_projector_camera * point).hnormalized());
    EXPECT_NEAR(rgb_value(image, panel.y(), panel.x(), 1), sinusoid(pattern, pixel.y()), kLevel);
  }
}

TEST(PatternImage, RectifiedAPointHasThePhaseOfTheParallelProjector) {
  const Rig rig = small_distorted_rig();
  const DrawOptions options{.rectify = true, .bits = 16};
  const Rig drawn = rig_of_drawing(rig, options);
  EXPECT_TRUE(drawn.T_projector_camera.linear().isIdentity(0));
  const Eigen::Vector3d center = rig.T_projector_camera.inverse().translation();
  EXPECT_LT((drawn.T_projector_camera * center).norm(), 1e-9);  // [mm] it stands in the same place
  for (const Axis axis : {Axis::y, Axis::x}) {
    const Pattern pattern{.axis = axis, .period = 11};
    const cv::Mat image = draw_pattern(pattern, rig, options);
    for (const Eigen::Vector2d& panel : {Eigen::Vector2d(0, 0), {103, 70}, {199, 149}, {3, 140}}) {
      const Eigen::Vector3d ray = geometry::undistort(rig.projector, panel).homogeneous();
      const Eigen::Vector3d point = rig.T_projector_camera.inverse() * (700 * ray);
      const Eigen::Vector3d seen = drawn.T_projector_camera * point;
      const double u = drawn.projector.fx * seen.x() / seen.z() + drawn.projector.cx;
      const double v = drawn.projector.fy * seen.y() / seen.z() + drawn.projector.cy;
      EXPECT_NEAR(rgb_value(image, panel.y(), panel.x(), 1),
                  sinusoid(pattern, axis == Axis::x ? u : v), kLevel);
      EXPECT_GE(std::min(u, v), -0.5 - 1e-9);
      EXPECT_LE(u, drawn.projector.width - 0.5);
      EXPECT_LE(v, drawn.projector.height - 0.5);
    }
  }
}

TEST(PatternImage, RectifyingAParallelProjectorChangesNothing) {
  const Rig rig = make_rig(false);
  const Rig drawn = rig_of_drawing(rig, {.rectify = true});
  EXPECT_EQ(drawn.projector.width, rig.projector.width);
  EXPECT_EQ(drawn.projector.height, rig.projector.height);
  EXPECT_NEAR(drawn.projector.cx, rig.projector.cx, 1e-9);
  EXPECT_NEAR(drawn.projector.cy, rig.projector.cy, 1e-9);
}

// A compensated channel must reach each direction with green's phase: the compensation removes the
// lag that the decoder's model predicts for the plain drawing.
TEST(PatternImage, CompensationTakesAwayTheLagThatTheDecoderModels) {
  for (const Axis axis : {Axis::y, Axis::x}) {
    const Rig rig = small_distorted_rig();
    const Pattern pattern{.axis = axis, .period = 11, .phase = 0.3};
    const cv::Mat image = draw_pattern(pattern, rig, {.bits = 16});
    const double focal = axis == Axis::x ? rig.projector.fx : rig.projector.fy;
    const double center = axis == Axis::x ? rig.projector.cx : rig.projector.cy;
    for (const int channel : {0, 2}) {
      const ChromaticShift& shift = channel == 0 ? rig.red : rig.blue;
      for (const int panel : {2, 60, 140}) {
        const double as_green =
            focal * (shift.beta * (panel - center) / focal + shift.gamma) + center;
        const double lag = chromatic_lag(shift, rig.projector, pattern).at(as_green);
        const double expected =
            pattern.mean +
            pattern.amplitude *
                std::cos(2 * std::numbers::pi * panel / pattern.period + pattern.phase + lag);
        const double drawn = axis == Axis::x ? rgb_value(image, 9, panel, channel)
                                             : rgb_value(image, panel, 9, channel);
        EXPECT_NEAR(drawn, expected, kLevel);
      }
    }
  }
}

TEST(PatternImage, CompensationShiftsTheStripesToo) {
  Rig rig = small_distorted_rig();
  rig.red.beta = 1.03;
  const Pattern pattern{.colors = {{"R", {1, 0, 0}}, {"C", {0, 1, 1}}},
                        .stripes = {0, 1},
                        .stripe_edges = {189.5},
                        .period = 11};
  const cv::Mat image = draw_pattern(pattern, rig, {.bits = 16});
  // Red's edge where 1.03 (u - 101) + 101 = 189.5: u = 186.92.
  EXPECT_GT(rgb_value(image, 70, 186, 0), 0.01);
  EXPECT_EQ(rgb_value(image, 70, 188, 0), 0);
  EXPECT_EQ(rgb_value(image, 70, 189, 1), 0);  // green's stays
  EXPECT_GT(rgb_value(image, 70, 190, 1), 0.01);
}

TEST(PatternImage, TheRigOfADrawingSaysWhatWasTakenCareOf) {
  const Rig rig = small_distorted_rig();
  const Rig drawn = rig_of_drawing(rig);
  EXPECT_EQ(drawn.red.alpha, 0.998);
  EXPECT_EQ(drawn.red.beta, 1);
  EXPECT_EQ(drawn.blue.gamma, 0);
  EXPECT_EQ(drawn.projector.distortion, rig.projector.distortion);
  const Rig plain = rig_of_drawing(rig, {.compensate = false});
  EXPECT_EQ(plain.red.beta, rig.red.beta);
  EXPECT_EQ(plain.blue.gamma, rig.blue.gamma);
  const Pattern pattern{.period = 11};
  const cv::Mat one = draw_pattern(pattern, rig, {.compensate = false});
  const cv::Mat other = draw_pattern(pattern, rig.projector.width, rig.projector.height);
  EXPECT_EQ(cv::norm(one, other, cv::NORM_INF), 0);
}

TEST(PatternImage, TrainingPatternsKeepTheSinusoid) {
  const Pattern pattern = design_pattern(320, 240).pattern;
  const cv::Mat green = draw_pattern(single_color(pattern, 2), 320, 240, 16);
  const cv::Mat white = draw_pattern(without_stripes(pattern), 320, 240, 16);
  for (int v = 0; v < 240; ++v) {
    EXPECT_NEAR(rgb_value(green, v, 300, 1), sinusoid(pattern, v), kLevel);
    EXPECT_EQ(rgb_value(green, v, 300, 0), 0);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(rgb_value(white, v, 11, channel), sinusoid(pattern, v), kLevel);
  }
  const cv::Mat flat = draw_uniform({1, 0.5, 0}, 5, 4, 8);
  EXPECT_EQ(flat.at<cv::Vec3b>(3, 4), cv::Vec3b(0, 128, 255));
  const std::vector<int> levels = grey_levels(18);
  EXPECT_EQ(levels.front(), 0);
  EXPECT_EQ(levels[1], 15);
  EXPECT_EQ(levels.back(), 255);
}

TEST(PatternImage, RefusesWhatCannotBeDrawn) {
  Rig rig = small_distorted_rig();
  const Pattern pattern{.period = 11};
  EXPECT_THROW((void)draw_pattern(pattern, rig, {.bits = 12}), InvalidInput);
  EXPECT_THROW((void)draw_pattern(pattern, 0, 10), InvalidInput);
  EXPECT_THROW((void)draw_pattern({.period = -1}, 10, 10), InvalidInput);
  EXPECT_THROW((void)draw_uniform({0, 0, 1.1}, 4, 4), InvalidInput);
  EXPECT_THROW((void)single_color(pattern, 0), InvalidInput);
  EXPECT_THROW((void)grey_levels(1), InvalidInput);
  rig.T_projector_camera.linear() =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const std::string message =
      message_of<InvalidInput>([&] { (void)rig_of_drawing(rig, {.rectify = true}); });
  EXPECT_NE(message.find("straight"), std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
