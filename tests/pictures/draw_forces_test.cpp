// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_forces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

constexpr int kCount = 3001;

/// Within the axes of the chart, whose left end depends on its numbers by a few pixels.
const Region kForcesPlot(100, 145, 1060, 460);

/// 3 s at 1 kHz: free for 1 s, then stick, then slip; the force grows along one axis.
struct Trace {
  Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(kCount, 0, 3);
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, kCount);
  Eigen::VectorXi states = Eigen::VectorXi::Zero(kCount);

  Trace() {
    forces.row(0).setLinSpaced(-1, 3);
    forces.row(1).setConstant(-1.5);
    forces.row(2).setConstant(-2);
    states.segment(1000, 1000).setConstant(1);
    states.tail(1001).setConstant(2);
  }
};

cv::Mat3b forces_picture(const Trace& trace) {
  return draw_picture([&](const std::filesystem::path& png) {
    draw_forces(png, trace.times, trace.forces, trace.states, "Forces");
  });
}

/// The colour of the background at a fraction of the time.
Rgb background(const cv::Mat3b& picture, double fraction) {
  return pixel(picture, kForcesPlot.x + static_cast<int>(fraction * kForcesPlot.width), 575);
}

TEST(DrawForces, LinesFollowTheForces) {
  const cv::Mat3b picture = forces_picture({});
  EXPECT_EQ(picture.size(), cv::Size(1200, 700));
  double last = kForcesPlot.height;
  for (int x = 20; x < kForcesPlot.width; x += 100) {
    const cv::Mat1b column =
        mask_of(picture, kVermilion, 60, {kForcesPlot.x + x, kForcesPlot.y, 1, kForcesPlot.height});
    ASSERT_GT(cv::countNonZero(column), 0) << "a gap in the line of fx at " << x;
    const double y = center_of(column).y();
    EXPECT_LT(y, last) << "fx grows all the time";
    last = y;
  }
  // fz is constant: one thin row of pixels over the whole width.
  const cv::Mat1b constant = mask_of(picture, kBlue, 60, kForcesPlot);
  EXPECT_GT(cv::countNonZero(constant), 0.9 * kForcesPlot.width);
  EXPECT_LT(cv::countNonZero(constant), 3.2 * kForcesPlot.width);
}

TEST(DrawForces, LinesHaveNoGapsAtManySamplesAPixel) {
  const cv::Mat3b picture = forces_picture({});
  for (int x = 5; x < kForcesPlot.width - 5; ++x) {
    EXPECT_GT(cv::countNonZero(mask_of(picture, kVermilion, 90,
                                       {kForcesPlot.x + x, kForcesPlot.y, 1, kForcesPlot.height})),
              0);
  }
}

TEST(DrawForces, BackgroundFollowsTheStates) {
  const cv::Mat3b picture = forces_picture({});
  const Rgb free = background(picture, 0.1);
  const Rgb stick = background(picture, 0.5);
  const Rgb slip = background(picture, 0.9);
  EXPECT_EQ(free, (Rgb{255, 255, 255}));
  EXPECT_GT(stick[2], stick[0] + 15) << "blue";
  EXPECT_GT(slip[0], slip[2] + 15) << "orange";
  // The border between stick and slip is at two thirds of the time.
  EXPECT_EQ(background(picture, 0.64), stick);
  EXPECT_EQ(background(picture, 0.69), slip);
}

TEST(DrawForces, NaNBreaksTheLine) {
  Trace trace;
  trace.forces.middleCols(1200, 600).setConstant(std::nan(""));
  const cv::Mat3b picture = forces_picture(trace);
  const Region gap(kForcesPlot.x + kForcesPlot.width * 9 / 20, kForcesPlot.y,
                   kForcesPlot.width / 10, kForcesPlot.height);
  for (const Rgb& color : {kVermilion, kBlue, kBlack}) {
    EXPECT_EQ(cv::countNonZero(mask_of(picture, color, 60, gap)), 0);
  }
}

TEST(DrawForces, DrawsTwoSamplesAndForcesThatAreZero) {
  Trace trace;
  trace.times = Eigen::Vector2d(1, 2);
  trace.forces.setZero(3, 2);
  trace.states.setZero(2);
  EXPECT_EQ(forces_picture(trace).size(), cv::Size(1200, 700));
  trace.times(1) = 1;
  EXPECT_EQ(forces_picture(trace).size(), cv::Size(1200, 700));
}

TEST(DrawForces, RefusesInputThatDoesNotFit) {
  Trace trace;
  const auto attempt = [&trace](const std::filesystem::path& png) {
    draw_forces(png, trace.times, trace.forces, trace.states, "");
  };
  trace.times(9) = 0;
  expect_refused(attempt, "times: entry 9 is earlier");
  trace.times(9) = std::nan("");
  expect_refused(attempt, "times: entry 9 is nan s; it must be finite");
  trace = {};
  trace.states(11) = 3;
  expect_refused(attempt, "states: entry 11 is 3");
  trace.states.conservativeResize(5);
  expect_refused(attempt, "states: has 5 entries where 3001 are needed");
  trace.forces.conservativeResize(3, 4);
  expect_refused(attempt, "forces: has 4 entries where 3001 are needed");
  trace = {};
  trace.forces.setConstant(std::nan(""));
  expect_refused(attempt, "forces: holds no finite value");
  trace.times.resize(0);
  expect_refused(attempt, "times: at least two are needed");
}

TEST(DrawForces, GivesTheSameBytesAgain) {
  expect_same_again([](const std::filesystem::path& png) {
    const Trace trace;
    draw_forces(png, trace.times, trace.forces, trace.states, "Again");
  });
}

TEST(DrawForces, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    const Trace trace;
    draw_forces(png, trace.times, trace.forces, trace.states, "");
  });
}

}  // namespace
}  // namespace palpate::pictures
