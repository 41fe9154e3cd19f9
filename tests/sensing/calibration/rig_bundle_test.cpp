// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/rig_bundle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "calibration/synthetic_board.h"

namespace palpate::sensing {
namespace {

struct Problem {
  Bundle truth;
  std::vector<BundleView> views;
};

Problem make_problem(double sigma) {
  const Rig rig = make_board_rig();
  Problem problem{{rig.camera, rig.projector, rig.T_projector_camera, board_poses(6)}, {}};
  for (const RigView& view : make_views(rig, board_poses(6), sigma, sigma))
    problem.views.push_back({view.board, view.camera, view.lit_board, view.projector});
  return problem;
}

double total_squares(const Bundle& bundle, const std::vector<BundleView>& views) {
  double sum = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BundleResiduals residuals = bundle_residuals(bundle, views[v], v);
    sum += residuals.camera.squaredNorm() + residuals.projector.squaredNorm();
  }
  return sum;
}

TEST(RigBundle, FindsTheTruthFromADistance) {
  const Problem problem = make_problem(0);
  Bundle start = problem.truth;
  start.camera.fx *= 1.05;
  start.projector.cy -= 30;
  start.projector.distortion = {};
  start.T_projector_camera.prerotate(
      Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized()));
  start.T_camera_board[2].pretranslate(Eigen::Vector3d(5, -3, 20));
  const Bundle found = refine_bundle(start, problem.views, {});
  constexpr double kRounding =
      1e-6;  // px: the pixels are exact to 1e-13, the board fixes 1e-4 of them
  EXPECT_NEAR(found.camera.fx, problem.truth.camera.fx, kRounding);
  EXPECT_NEAR(found.projector.cy, problem.truth.projector.cy, kRounding);
  EXPECT_NEAR(found.projector.distortion[0], problem.truth.projector.distortion[0], kRounding);
  EXPECT_TRUE(found.T_projector_camera.isApprox(problem.truth.T_projector_camera, 1e-8));
  EXPECT_TRUE(found.T_camera_board[2].isApprox(problem.truth.T_camera_board[2], 1e-8));
}

TEST(RigBundle, ComesToTheMinimumOfOpenCv) {
  const Problem problem = make_problem(0.2);
  const Bundle found = refine_bundle(problem.truth, problem.views, {});
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> camera;
  std::vector<std::vector<cv::Point2f>> projector;
  const auto points = [](const Eigen::Matrix2Xd& pixels) {
    std::vector<cv::Point2f> list;
    for (const auto& p : pixels.colwise())
      list.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    return list;
  };
  for (const BundleView& view : problem.views) {
    board.emplace_back();
    for (const cv::Point2f& p : points(view.board)) board.back().emplace_back(p.x, p.y, 0.0F);
    camera.push_back(points(view.camera));
    projector.push_back(points(view.projector));
  }
  const auto matrix_of = [](const geometry::Camera& lens) {
    return cv::Mat(cv::Matx33d(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1));
  };
  const auto distortion_of = [](const geometry::Camera& lens) {
    return cv::Mat(std::vector<double>(lens.distortion.begin(), lens.distortion.begin() + 5), true);
  };
  cv::Mat K1 = matrix_of(problem.truth.camera);
  cv::Mat K2 = matrix_of(problem.truth.projector);
  cv::Mat d1 = distortion_of(problem.truth.camera);
  cv::Mat d2 = distortion_of(problem.truth.projector);
  cv::Mat R;
  cv::Mat t;
  const double peer = cv::stereoCalibrate(
      board, camera, projector, K1, d1, K2, d2, cv::Size(640, 480), R, t, cv::noArray(),
      cv::noArray(), cv::CALIB_USE_INTRINSIC_GUESS, cv::TermCriteria(3, 200, 1e-12));
  double count = 0;
  for (const BundleView& view : problem.views)
    count += static_cast<double>(view.camera.cols() + view.projector.cols());
  const double ours = std::sqrt(total_squares(found, problem.views) / count);
  // OpenCV's points are floats, and it stops a little above its minimum.
  EXPECT_LE(ours, peer * (1 + 1e-6));
  EXPECT_NEAR(ours, peer, 1e-3 * peer);
  EXPECT_NEAR(found.camera.fx, K1.at<double>(0, 0), 0.05);
  EXPECT_NEAR(found.projector.cy, K2.at<double>(1, 2), 0.2);
  EXPECT_NEAR(found.T_projector_camera.translation().y(), t.at<double>(1), 0.05);
}

TEST(RigBundle, CovarianceGrowsWithTheSquareOfSigma) {
  const Problem problem = make_problem(0);
  const Eigen::MatrixXd one = bundle_covariance(problem.truth, problem.views, {});
  const Eigen::MatrixXd two =
      bundle_covariance(problem.truth, problem.views, {.camera_sigma = 2, .projector_sigma = 2});
  EXPECT_GT(one.diagonal().minCoeff(), 0);
  EXPECT_TRUE(two.isApprox(4 * one, 1e-6));
}

TEST(RigBundle, WhatIsFixedStays) {
  const Problem problem = make_problem(0.2);
  const BundleOptions options{.distortion_terms = 2, .camera_is_fixed = true};
  Bundle start = problem.truth;
  start.projector.fx *= 1.02;
  const Bundle found = refine_bundle(start, problem.views, options);
  EXPECT_EQ(found.camera.fx, start.camera.fx);
  EXPECT_TRUE(found.T_camera_board[0].isApprox(start.T_camera_board[0], 0));
  EXPECT_EQ(found.projector.distortion[2], start.projector.distortion[2]);
  EXPECT_LT(total_squares(found, problem.views), total_squares(start, problem.views));
  const Eigen::MatrixXd covariance = bundle_covariance(found, problem.views, options);
  EXPECT_EQ(covariance(0, 0), 0);
  EXPECT_EQ(covariance(15, 15), 0) << "p1 of the projector";
  EXPECT_GT(covariance(9, 9), 0);
}

}  // namespace
}  // namespace palpate::sensing
