// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/motion_smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "throws_message.h"

namespace palpate::geometry {
namespace {

using Eigen::Matrix3Xd;

/// A sequence of 30 frames/s of which one frame is lost.
std::vector<double> usual_times() {
  std::vector<double> times;
  for (int i = 0; i < 40; ++i)
    if (i != 17) times.push_back(i / 30.0);
  return times;
}

/// V points on parabolas of their own.
Matrix3Xd on_parabolas(double time, Eigen::Index vertices = 5) {
  Matrix3Xd points(3, vertices);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    const auto k = static_cast<double>(v);
    points.col(v) << k + 20 * time, -k * 30 * time * time, 700 + 5 * time - 12 * time * time;
  }
  return points;
}

std::vector<Matrix3Xd> frames_of(const std::vector<double>& times,
                                 Matrix3Xd (*positions)(double, Eigen::Index),
                                 Eigen::Index vertices) {
  std::vector<Matrix3Xd> frames;
  for (const double time : times) frames.push_back(positions(time, vertices));
  return frames;
}

/// Points that swing by 3 mm at 1 Hz, each at another phase.
Matrix3Xd swinging(double time, Eigen::Index vertices) {
  Matrix3Xd points(3, vertices);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    const double phase = 2 * std::numbers::pi * (time + 0.001 * static_cast<double>(v));
    points.col(v) << 3 * std::sin(phase), 3 * std::cos(phase), 700;
  }
  return points;
}

void add_noise(std::vector<Matrix3Xd>& frames, double sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, sigma);
  for (Matrix3Xd& frame : frames)
    for (double& number : frame.reshaped()) number += noise(random);
}

TEST(SmoothMotion, LeavesParabolasAsTheyAreAlsoAtTheEndsAndBesideALostFrame) {
  const std::vector<double> times = usual_times();
  const std::vector<Matrix3Xd> frames = frames_of(times, on_parabolas, 5);
  for (const double time : times) {
    const SmoothedMotion smooth = smooth_motion(frames, times, time, 0.2);
    EXPECT_LT((smooth.positions - on_parabolas(time)).cwiseAbs().maxCoeff(), 1e-9) << time;
    for (Eigen::Index v = 0; v < 5; ++v) {
      const Eigen::Vector3d velocity(20, -60.0 * static_cast<double>(v) * time, 5 - 24 * time);
      EXPECT_LT((smooth.velocity.col(v) - velocity).norm(), 1e-8) << time;
    }
    EXPECT_LT(smooth.sigma.maxCoeff(), 1e-9);
  }
}

TEST(SmoothMotion, StatesTheDeviationThatIsLeft) {
  constexpr Eigen::Index kVertices = 400;
  constexpr double kScatter = 0.2;
  const std::vector<double> times = usual_times();
  std::vector<Matrix3Xd> frames = frames_of(times, swinging, kVertices);
  add_noise(frames, kScatter);
  for (const std::size_t at : {std::size_t{0}, std::size_t{16}, std::size_t{25}}) {
    const SmoothedMotion smooth = smooth_motion(frames, times, times[at], 0.15);
    const Matrix3Xd error = smooth.positions - swinging(times[at], kVertices);
    const double actual = std::sqrt(error.squaredNorm() / (3 * kVertices));
    const double stated = std::sqrt(smooth.sigma.squaredNorm() / kVertices);
    EXPECT_GT(stated / actual, 0.85) << at;
    EXPECT_LT(stated / actual, 1.15) << at;
    if (at > 0) EXPECT_LT(actual, 0.7 * kScatter);  // the first frame has neighbours on one side
  }
}

// A filter of the past would be late: here, the error would have the sign of the velocity.
TEST(SmoothMotion, HasNoLag) {
  constexpr Eigen::Index kVertices = 1000;  // over all phases
  const std::vector<double> times = usual_times();
  const SmoothedMotion smooth =
      smooth_motion(frames_of(times, swinging, kVertices), times, times[25], 0.2);
  const Matrix3Xd error = smooth.positions - swinging(times[25], kVertices);
  const double speed = smooth.velocity.squaredNorm();
  const double lag = -error.cwiseProduct(smooth.velocity).sum() / speed;  // [s]
  EXPECT_LT(std::abs(lag), 1e-3 / 30);
}

TEST(SmoothMotion, FollowsTheUnitOfTime) {
  const std::vector<double> times = usual_times();
  std::vector<Matrix3Xd> frames = frames_of(times, swinging, 20);
  add_noise(frames, 0.1);
  std::vector<double> milliseconds = times;
  for (double& time : milliseconds) time *= 1000;
  const SmoothedMotion in_s = smooth_motion(frames, times, times[20], 0.15);
  const SmoothedMotion in_ms = smooth_motion(frames, milliseconds, milliseconds[20], 150);
  EXPECT_LT((in_s.positions - in_ms.positions).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((in_s.velocity - 1000 * in_ms.velocity).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((in_s.sigma - in_ms.sigma).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SmoothMotion, RefusesWhatItCannotSmooth) {
  const std::vector<double> times = usual_times();
  std::vector<Matrix3Xd> frames = frames_of(times, swinging, 3);
  const std::vector<double> two = {0, 1};
  const auto smooth_at = [&](const std::vector<double>& at, double window) {
    (void)smooth_motion(frames, at, 0.5, window);
  };
  EXPECT_EQ(frames_in_window(times, times[30], 0.05), 3);
  EXPECT_THROWS_MESSAGE(smooth_at(times, 0.05), InvalidInput,
                        "the window has 3 frames; at least 4");
  EXPECT_THROWS_MESSAGE(smooth_at(times, -1), InvalidInput, "window");
  EXPECT_THROWS_MESSAGE(smooth_at(two, 1), InvalidInput, "39 frames and 2 times");
  std::vector<double> equal = times;
  equal[4] = equal[3];
  EXPECT_THROWS_MESSAGE(smooth_at(equal, 1), InvalidInput, "must ascend");
  frames[14](1, 2) = std::nan("");
  EXPECT_THROWS_MESSAGE(smooth_at(times, 0.2), InvalidInput,
                        "frame 14 has a position that is not finite");
  frames[14] = Matrix3Xd::Zero(3, 4);
  EXPECT_THROWS_MESSAGE(smooth_at(times, 0.2), InvalidInput, "has 4 vertices");
}

}  // namespace
}  // namespace palpate::geometry
