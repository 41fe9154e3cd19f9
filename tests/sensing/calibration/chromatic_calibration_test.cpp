// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/chromatic_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/synthetic_board.h"
#include "palpate/core/error.h"
#include "palpate/sensing/rig_calibration.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

/// Accuracy that this calibration needs: alpha, beta, and gamma in projector pixels.
constexpr double kFactorTolerance = 5e-5;
constexpr double kPixelTolerance = 0.1;

constexpr ChromaticShift kRed{.alpha = 0.9985, .beta = 1.0012, .gamma = 0.0004};
constexpr ChromaticShift kBlue{.alpha = 1.0017, .beta = 0.9991, .gamma = -0.0003};

Pattern white_sinusoid(Axis axis, double period) {
  return {.axis = axis, .period = period, .phase = 0.7, .mean = 0.575, .amplitude = 0.425};
}

Rig with_shifts(Rig rig) {
  rig.red = kRed;
  rig.blue = kBlue;
  return rig;
}

/// Planes at several distances, tilted below 500 mm and beyond 700 mm, with noise, and with their
/// depths, so that no plane has to be searched.
std::vector<WhiteImage> views(const Rig& rig, const Pattern& pattern,
                              const std::vector<double>& distances, double noise = 0.005,
                              unsigned seed = 1) {
  std::vector<WhiteImage> images;
  for (const double z : distances) {
    const Eigen::Vector3d normal(0.1 * (z > 700 ? 1 : 0), -0.2 * (z < 500 ? 1 : 0), 1);
    Scene scene = render(rig, pattern, plane(normal, z));
    add_noise(scene.frame, noise, seed++);
    images.push_back({.name = std::to_string(z), .image = scene.frame, .depth = scene.z});
  }
  return images;
}

void expect_found(const ChannelCalibration& channel, const ChromaticShift& truth, double focal) {
  EXPECT_NEAR(channel.shift.alpha, truth.alpha, kFactorTolerance);
  EXPECT_NEAR(channel.shift.beta, truth.beta, kFactorTolerance);
  EXPECT_NEAR(channel.shift.gamma * focal, truth.gamma * focal, kPixelTolerance);
  // Five deviations: the errors of a right estimate exceed them once in a million.
  EXPECT_LT(std::abs(channel.shift.alpha - truth.alpha), 5 * channel.deviation.alpha);
  EXPECT_LT(std::abs(channel.shift.beta - truth.beta), 5 * channel.deviation.beta);
  EXPECT_LT(std::abs(channel.shift.gamma - truth.gamma), 5 * channel.deviation.gamma);
  EXPECT_LT(channel.deviation.alpha, kFactorTolerance);
  EXPECT_LT(channel.deviation.beta, kFactorTolerance);
  EXPECT_LT(channel.rms_after, 0.2 * channel.rms_before);
}

TEST(ChromaticCalibration, FindsTheShiftsForEitherPoseAndAxis) {
  for (const bool verging : {false, true}) {
    for (const Axis axis : {Axis::y, Axis::x}) {
      SCOPED_TRACE(std::string(verging ? "verging, " : "parallel, ") +
                   (axis == Axis::x ? "x" : "y"));
      const Rig rig = with_shifts(make_rig(verging));
      const Pattern pattern = white_sinusoid(axis, 20);
      const auto found =
          calibrate_chromatic(views(rig, pattern, {420, 600, 900}), make_rig(verging), pattern);
      expect_found(found.red, kRed, rig.projector.fy);
      expect_found(found.blue, kBlue, rig.projector.fy);
      EXPECT_TRUE(found.images[1].problem.empty());
      EXPECT_NEAR(found.images[1].median_depth.value(), 600, 6);
      EXPECT_FALSE(found.images[1].period_deviation) << "the depths were given";
    }
  }
}

TEST(ChromaticCalibration, FindsTheShiftsThroughDistortedLenses) {
  Rig rig = with_shifts(make_rig(true));
  rig.camera.distortion = {-0.1, 0.03, 0.001, -0.0005};
  rig.projector.distortion = {-0.05, 0.02, -0.0005, 0.001};
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  const auto found = calibrate_chromatic(views(rig, pattern, {420, 600, 900}), rig, pattern);
  expect_found(found.red, kRed, rig.projector.fy);
  expect_found(found.blue, kBlue, rig.projector.fy);
}

TEST(ChromaticCalibration, FindsShiftsOfMoreThanHalfAPeriodInTheImage) {
  Rig rig = make_rig(false);
  rig.red = {.alpha = 0.985, .beta = 1.014, .gamma = 0.004};
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  const auto found =
      calibrate_chromatic(views(rig, pattern, {420, 600, 900}), make_rig(false), pattern);
  EXPECT_GT(found.red.rms_before, 1);
  EXPECT_NEAR(found.red.shift.alpha, 0.985, 2 * kFactorTolerance);
  EXPECT_NEAR(found.red.shift.beta, 1.014, 2 * kFactorTolerance);
  EXPECT_NEAR(found.red.shift.gamma * 1500, 6, kPixelTolerance);
  EXPECT_NEAR(found.blue.shift.alpha, 1, kFactorTolerance);
}

TEST(ChromaticCalibration, FindsThePeriodOfPlanesByItself) {
  const Rig rig = with_shifts(make_rig(true));
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  std::vector<WhiteImage> images = views(rig, pattern, {420, 600, 900}, 0.001);
  for (WhiteImage& image : images) image.depth.reset();
  Rig exact = make_rig(true);
  exact.covariance.emplace().setZero();
  const auto found = calibrate_chromatic(images, exact, pattern);
  expect_found(found.red, kRed, rig.projector.fy);
  expect_found(found.blue, kBlue, rig.projector.fy);
  EXPECT_GT(found.images[1].period_deviation.value(), 0);
  EXPECT_NEAR(found.images[1].median_depth.value(), 600, 6);  // a period is about 40 mm
}

TEST(ChromaticCalibration, ACalibratedRigGivesTheRightPeriodOrNone) {
  const Rig truth = make_board_rig();
  Rig calibrated =
      calibrate_rig(make_views(truth, board_poses(12), 0.02, 0.02, 21), {640, 480}, kPanel).rig;
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  // The calibration's error makes another number of periods fit a plane better.
  const Scene far = render(truth, pattern, plane({-0.01, 0.104, 1}, 813.2));
  std::vector<WhiteImage> images = views(truth, pattern, {440, 600, 860});
  images.push_back({.name = "far", .image = far.frame});
  for (const bool with_covariance : {true, false}) {
    if (!with_covariance) calibrated.covariance.reset();
    const WhiteImageUse use = calibrate_chromatic(images, calibrated, pattern).images.back();
    EXPECT_NEAR(use.median_depth.value_or(812.8), 812.8, 20);  // a period is about 130 mm
  }
}

TEST(ChromaticCalibration, DeviationsShrinkWithNoiseAndWithTheNumberOfImages) {
  const Rig rig = with_shifts(make_rig(false));
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  const auto deviation = [&](const std::vector<double>& distances, double noise) {
    return calibrate_chromatic(views(rig, pattern, distances, noise), rig, pattern).red.deviation;
  };
  const ChromaticShift noisy = deviation({420, 600, 900}, 0.02);
  const ChromaticShift clean = deviation({420, 600, 900}, 0.005);
  const ChromaticShift many = deviation({420, 600, 900, 420, 600, 900, 420, 600, 900}, 0.02);
  // In proportion to the noise, and to the root of the number; a variance from some hundred blocks
  // is itself known to about a tenth.
  EXPECT_NEAR(noisy.alpha / clean.alpha, 4, 1);
  EXPECT_NEAR(noisy.beta / clean.beta, 4, 1);
  EXPECT_NEAR(noisy.gamma / many.gamma, std::sqrt(3), 0.5);
  EXPECT_NEAR(noisy.alpha / many.alpha, std::sqrt(3), 0.5);
}

TEST(ChromaticCalibration, DeviationsAreThoseOfTheErrors) {
  const Rig rig = with_shifts(make_rig(false));
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  double sum = 0;
  int count = 0;
  for (unsigned trial = 0; trial < 6; ++trial) {
    const auto found =
        calibrate_chromatic(views(rig, pattern, {420, 900}, 0.02, 100 * trial), rig, pattern);
    const auto add = [&](const ChannelCalibration& channel, const ChromaticShift& truth) {
      sum += std::pow((channel.shift.alpha - truth.alpha) / channel.deviation.alpha, 2);
      sum += std::pow((channel.shift.beta - truth.beta) / channel.deviation.beta, 2);
      count += 2;
    };
    add(found.red, kRed);
    add(found.blue, kBlue);
  }
  // The mean square of 24 Gaussian errors, which depend on each other in pairs.
  EXPECT_GT(std::sqrt(sum / count), 0.5);
  EXPECT_LT(std::sqrt(sum / count), 1.6);
}

TEST(ChromaticCalibration, LeavesOutWhatIsNoSinusoid) {
  const Rig rig = with_shifts(make_rig(false));
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  std::vector<WhiteImage> images = views(rig, pattern, {420, 600, 900});
  for (WhiteImage& white : images) {
    white.image(cv::Rect(30, 40, 60, 50)).setTo(cv::Scalar::all(65535));      // a highlight
    white.image(cv::Rect(200, 100, 40, 90)).setTo(cv::Scalar::all(0));        // a shadow
    white.image(cv::Rect(120, 170, 50, 40)).setTo(cv::Scalar(9000, 4e4, 0));  // a sticker
  }
  const auto found = calibrate_chromatic(images, rig, pattern);
  expect_found(found.red, kRed, rig.projector.fy);
  expect_found(found.blue, kBlue, rig.projector.fy);
}

TEST(ChromaticCalibration, RefusesWhatDoesNotDetermineTheShifts) {
  const Rig rig = with_shifts(make_rig(false));
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  const auto refusal_of = [&](const std::vector<WhiteImage>& images) {
    return message_of<SolverError>([&] { (void)calibrate_chromatic(images, rig, pattern); });
  };
  EXPECT_THAT(refusal_of(views(rig, pattern, {600})), HasSubstr("several distances"));
  EXPECT_THAT(refusal_of(views(rig, pattern, {600, 605})), HasSubstr("several distances"));
  std::vector<WhiteImage> dark = views(rig, pattern, {420, 900});
  for (WhiteImage& white : dark) white.image.setTo(0);
  EXPECT_THAT(refusal_of(dark), HasSubstr("lit, modulated"));
  // A sphere without its depths.
  const Scene scene = render(rig, pattern, sphere({0, 0, 700}, 250));
  EXPECT_THAT(refusal_of({{.name = "ball", .image = scene.frame}}),
              HasSubstr("ball: the surface is not plane"));
  std::vector<WhiteImage> wrong = views(rig, pattern, {420, 900});
  for (WhiteImage& white : wrong) {
    for (int u = 0; u < 320; ++u) white.depth->col(u) += static_cast<float>(u);  // several periods
  }
  EXPECT_THAT(refusal_of(wrong), HasSubstr("do not agree"));
}

TEST(ChromaticCalibration, RefusesWrongArguments) {
  const Rig rig = make_rig(false);
  const Pattern pattern = white_sinusoid(Axis::y, 20);
  const WhiteImage good = views(rig, pattern, {600})[0];
  const auto refusal_of = [&](const std::vector<WhiteImage>& images,
                              const ChromaticCalibrationOptions& options) {
    return message_of<InvalidInput>(
        [&] { (void)calibrate_chromatic(images, rig, pattern, options); });
  };
  EXPECT_THAT(refusal_of({}, {}), HasSubstr("no images"));
  EXPECT_THAT(refusal_of({good}, {.min_signal = 0}), HasSubstr("min_signal"));
  EXPECT_THAT(refusal_of({good}, {.search_range = 0.3}), HasSubstr("search_range"));
  EXPECT_THAT(refusal_of({good}, {.min_contrast = NAN}), HasSubstr("min_contrast"));
  WhiteImage bad = good;
  bad.image = cv::Mat(240, 320, CV_8UC1);
  EXPECT_THAT(refusal_of({bad}, {}), HasSubstr("with 1 channel;"));
  bad.image = cv::Mat(100, 320, CV_8UC3);
  EXPECT_THAT(refusal_of({bad}, {}), HasSubstr("320 x 100"));
  bad = good;
  bad.depth = geometry::ImageF(3, 4);
  EXPECT_THAT(refusal_of({bad}, {}), HasSubstr("depth: is 4 x 3"));
}

}  // namespace
}  // namespace palpate::sensing
