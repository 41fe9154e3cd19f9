// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calibration/synthetic_board.h"

namespace palpate::sensing {
namespace {

struct Seen {
  std::vector<Eigen::Matrix2Xd> board, pixels;
};

/// Views of boards by the camera of `rig`, with noise of `sigma` [px].
Seen seen_boards(const Rig& rig, const std::vector<Eigen::Isometry3d>& poses, double sigma,
                 unsigned seed) {
  Seen result;
  for (const RigView& view : make_views(rig, poses, sigma, 0, seed)) {
    result.board.push_back(view.board);
    result.pixels.push_back(view.camera);
  }
  return result;
}

TEST(LensCalibration, FindsTheLensAndTheBoardsWithoutNoise) {
  const Rig rig = make_board_rig();
  const auto poses = board_poses(6);
  const auto [board, pixels] = seen_boards(rig, poses, 0, 1);
  const LensCalibration found = calibrate_lens(board, pixels, rig.camera, 4);
  constexpr double kSinglePrecision = 0.01;  // px: OpenCV takes the pixels as float
  EXPECT_NEAR(found.lens.fx, rig.camera.fx, kSinglePrecision);
  EXPECT_NEAR(found.lens.fy, rig.camera.fy, kSinglePrecision);
  EXPECT_NEAR(found.lens.cx, rig.camera.cx, kSinglePrecision);
  EXPECT_NEAR(found.lens.cy, rig.camera.cy, kSinglePrecision);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(found.lens.distortion[i], rig.camera.distortion[i], 1e-3) << i;
  ASSERT_EQ(found.T_lens_board.size(), poses.size());
  for (std::size_t v = 0; v < poses.size(); ++v)
    EXPECT_LT((found.T_lens_board[v].matrix() - poses[v].matrix()).norm(), 0.05) << v;
  EXPECT_LT(found.rms, 1e-3);
}

TEST(LensCalibration, TellsTheScatterOfWhatItFinds) {
  const Rig rig = make_board_rig();
  constexpr double kNoise = 0.2;  // px
  constexpr int kTrials = 40;
  double squares = 0, predicted = 0, rms = 0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const auto [board, pixels] = seen_boards(rig, board_poses(6), kNoise, trial);
    const LensCalibration found = calibrate_lens(board, pixels, rig.camera, 4);
    squares += std::pow(found.lens.fx - rig.camera.fx, 2);
    predicted += std::pow(found.deviation[0], 2);
    rms += found.rms / kTrials;
  }
  // Of 40 trials a variance is known to 22 %, a standard deviation to 11 %: three times that.
  EXPECT_NEAR(std::sqrt(squares / predicted), 1, 0.33);
  // Two coordinates a corner, each with the noise; the parameters take some of it.
  EXPECT_NEAR(rms, kNoise * std::sqrt(2.0), 0.1 * kNoise);
}

}  // namespace
}  // namespace palpate::sensing
