// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_smoothing.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "not_finite.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

constexpr int kRows = 60;
constexpr int kCols = 80;
constexpr double kSigma = 0.2;  // mm

using Depth = std::function<double(double u, double v)>;

/// A plane in space: 1 / z is linear in the pixel. Slants by 45 degrees at 500 px of focal length.
double slanted_plane(double u, double v) { return 1 / (1 / 700.0 + u / 500 / 700 + v / 900 / 700); }

/// A ball of 90 mm in radius before a camera of 500 px of focal length, without its rim.
double ball(double u, double v) {
  const double x = (u - kCols / 2.0) / 500, y = (v - kRows / 2.0) / 500;
  const double a = x * x + y * y + 1;
  return (700 - std::sqrt(700.0 * 700.0 - a * (700.0 * 700.0 - 90.0 * 90.0))) / a;
}

ImageF sampled(const Depth& depth) {
  ImageF z(kRows, kCols);
  for (int v = 0; v < kRows; ++v) {
    for (int u = 0; u < kCols; ++u) z(v, u) = static_cast<float>(depth(u, v));
  }
  return z;
}

ImageF noisy(const ImageF& z, const ImageF& sigma, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  ImageF result = z;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    result.data()[i] += static_cast<float>(normal(random)) * sigma.data()[i];
  return result;
}

ImageF constant(double value) { return ImageF::Constant(kRows, kCols, static_cast<float>(value)); }

double rms(const ImageF& error) { return std::sqrt(error.cast<double>().square().mean()); }

TEST(RangeMapSmoothing, TakesMostOfTheNoiseFromPlanesAndCurvedSurfaces) {
  const ImageF sigma = constant(kSigma);
  for (const auto& [depth, most] :
       {std::pair<Depth, double>(slanted_plane, 0.5), std::pair<Depth, double>(ball, 0.5)}) {
    const ImageF truth = sampled(depth);
    const ImageF measured = noisy(truth, sigma);
    const double before = rms(measured - truth);
    EXPECT_NEAR(before, kSigma, 0.02);
    EXPECT_LT(rms(smooth_range_map(measured, sigma) - truth), most * before);
    // Free to move, the fit of six numbers to 49 is what remains.
    EXPECT_LT(rms(smooth_range_map(measured, sigma, {.max_move = 10}) - truth), 0.4 * before);
  }
}

TEST(RangeMapSmoothing, LeavesSurfacesOfSecondOrderAsTheyAre) {
  const ImageF plane = sampled(slanted_plane);
  // Float has 6e-5 mm at this depth.
  EXPECT_LT((smooth_range_map(plane, constant(kSigma)) - plane).abs().maxCoeff(), 2e-4);
}

TEST(RangeMapSmoothing, NoDepthMovesFurtherThanItMay) {
  ImageF sigma = constant(kSigma);
  sigma.leftCols(20) = 0.05F;
  const ImageF measured = noisy(sampled(ball), sigma);
  const ImageF moved = (smooth_range_map(measured, sigma) - measured).abs();
  EXPECT_LE((moved - sigma).maxCoeff(), 1e-4);
  EXPECT_GT(moved.maxCoeff(), 0.99 * kSigma);
  const ImageF less = (smooth_range_map(measured, sigma, {.max_move = 0.5}) - measured).abs();
  EXPECT_LE((less - 0.5 * sigma).maxCoeff(), 1e-4);
}

TEST(RangeMapSmoothing, KeepsStepsWhereTheyAre) {
  // Two planes 4 mm apart, which is 20 deviations: no pixel beside the step is drawn towards it.
  const ImageF truth =
      sampled([](double u, double v) { return slanted_plane(u, v) + (u < kCols / 2.0 ? 0 : 4); });
  const ImageF sigma = constant(kSigma);
  const ImageF measured = noisy(truth, sigma);
  const ImageF error = smooth_range_map(measured, sigma, {.max_move = 10}) - truth;
  const double inside = rms(error.leftCols(30));
  const double beside = rms(error.middleCols(kCols / 2 - 2, 4));
  EXPECT_LT(beside, 2 * inside);
  // On either side the mean stays.
  EXPECT_NEAR(error.col(kCols / 2 - 1).mean(), 0, 0.1);
  EXPECT_NEAR(error.col(kCols / 2).mean(), 0, 0.1);
}

TEST(RangeMapSmoothing, OneWrongDepthDoesNotSpoilItsNeighbours) {
  ImageF measured = sampled(slanted_plane);
  const ImageF truth = measured;
  measured(30, 40) += 50;
  ImageF error = (smooth_range_map(measured, constant(kSigma)) - truth).abs();
  EXPECT_GT(error(30, 40), 49);  // it moves by one deviation at most
  error(30, 40) = 0;
  EXPECT_LT(error.maxCoeff(), 1e-3);
}

TEST(RangeMapSmoothing, ACertainDepthCountsMoreThanAnUncertainOne) {
  const ImageF truth = sampled(slanted_plane);
  ImageF sigma = constant(1);
  for (int u = 0; u < kCols; u += 2) sigma.col(u) = 0.05F;
  const ImageF measured = noisy(truth, sigma);
  const ImageF error = smooth_range_map(measured, sigma, {.max_move = 10}) - truth;
  EXPECT_LT(rms(error), 0.06);  // without the weights, a third of 0.7
}

TEST(RangeMapSmoothing, UnknownStaysUnknownAndSaysNothing) {
  const ImageF sigma = constant(kSigma);
  ImageF measured = noisy(sampled(slanted_plane), sigma);
  measured.block(10, 10, 20, 3) = kFloatNaN;
  measured(40, 40) = -1;
  ImageF partly = sigma;
  partly.block(50, 50, 5, 5) = kFloatNaN;
  partly(5, 60) = 0;
  const ImageF result = smooth_range_map(measured, partly);
  EXPECT_TRUE((result.isNaN() == measured.isNaN()).all());
  EXPECT_EQ(result(40, 40), -1);
  EXPECT_TRUE((result.block(50, 50, 5, 5) == measured.block(50, 50, 5, 5)).all());
  EXPECT_EQ(result(5, 60), measured(5, 60));
  // Too few pixels for a surface: a line, a point.
  ImageF line = ImageF::Constant(9, 9, kFloatNaN);
  line.row(4).setLinSpaced(9, 700, 701);
  const ImageF of_line = smooth_range_map(line, ImageF::Constant(9, 9, 0.1F));
  EXPECT_TRUE((of_line.row(4) == line.row(4)).all());
}

TEST(RangeMapSmoothing, TurnsAndScalesWithTheImage) {
  const ImageF sigma = constant(kSigma);
  const ImageF measured = noisy(sampled(ball), sigma);
  const ImageF result = smooth_range_map(measured, sigma);
  const ImageF turned =
      smooth_range_map(measured.transpose().eval(), sigma.transpose().eval()).transpose();
  EXPECT_LT((turned - result).abs().maxCoeff(), 2e-4);
  const ImageF doubled = smooth_range_map(2 * measured, 2 * sigma) / 2;
  EXPECT_LT((doubled - result).abs().maxCoeff(), 2e-4);
}

TEST(RangeMapSmoothing, IsTheSameForEveryNumberOfThreads) {
  const ImageF sigma = constant(kSigma);
  const ImageF measured = noisy(sampled(ball), sigma);
  const ImageF result = smooth_range_map(measured, sigma);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE((smooth_range_map(measured, sigma) == result).all());
}

TEST(RangeMapSmoothing, RefusesWrongInput) {
  const ImageF z = constant(700);
  EXPECT_THROW((void)smooth_range_map(z, ImageF::Zero(3, 3)), InvalidInput);
  for (const RangeMapSmoothingOptions& options : std::initializer_list<RangeMapSmoothingOptions>{
           {.radius_px = 0}, {.radius_px = 16}, {.max_residual = 0}, {.max_move = std::nan("")}}) {
    EXPECT_THROW((void)smooth_range_map(z, z, options), InvalidInput);
  }
  EXPECT_EQ(smooth_range_map(ImageF(0, 0), ImageF(0, 0)).size(), 0);
}

}  // namespace
}  // namespace palpate::geometry
