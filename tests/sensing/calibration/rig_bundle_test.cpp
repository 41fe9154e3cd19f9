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

BundleView observed(const RigView& view) {
  return {view.board,      view.camera,    Eigen::VectorXd::Ones(view.camera.cols()),
          view.lit_camera, view.projector, Eigen::VectorXd::Ones(view.projector.cols())};
}

Problem make_problem(double sigma) {
  const Rig rig = make_board_rig();
  Problem problem{{rig.camera, rig.projector, rig.T_projector_camera, board_poses(6)}, {}};
  for (const RigView& view : make_views(rig, board_poses(6), sigma, sigma))
    problem.views.push_back(observed(view));
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
  // With an exact camera, the projector sees known points in space: one view of OpenCV's.
  const Rig rig = make_board_rig();
  Problem problem{{rig.camera, rig.projector, rig.T_projector_camera, board_poses(6)}, {}};
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> pixels;
  for (std::size_t v = 0; v < 6; ++v) {
    const RigView view = make_views(rig, {board_poses(6)[v]}, 0, 0.2, static_cast<unsigned>(v))[0];
    problem.views.push_back(observed(view));
    for (Eigen::Index i = 0; i < view.board.cols(); ++i) {
      const Eigen::Vector3f p =
          (board_poses(6)[v] * Eigen::Vector3d(view.board(0, i), view.board(1, i), 0))
              .cast<float>();
      points.emplace_back(p.x(), p.y(), p.z());
      pixels.emplace_back(static_cast<float>(view.projector(0, i)),
                          static_cast<float>(view.projector(1, i)));
    }
  }
  const Bundle found = refine_bundle(problem.truth, problem.views, {.camera_sigma = 1e-5});
  const geometry::Camera& start = problem.truth.projector;
  cv::Mat K(cv::Matx33d(start.fx, 0, start.cx, 0, start.fy, start.cy, 0, 0, 1));
  cv::Mat d(std::vector<double>(start.distortion.begin(), start.distortion.begin() + 5), true);
  std::vector<cv::Mat> R;
  std::vector<cv::Mat> t;
  const double peer =
      cv::calibrateCamera(std::vector<std::vector<cv::Point3f>>{points},
                          std::vector<std::vector<cv::Point2f>>{pixels}, cv::Size(512, 384), K, d,
                          R, t, cv::CALIB_USE_INTRINSIC_GUESS, cv::TermCriteria(3, 200, 1e-12));
  const double ours =
      std::sqrt(total_squares(found, problem.views) / static_cast<double>(points.size()));
  // The exact camera gives way by a hundred-thousandth.
  EXPECT_LE(ours, peer * (1 + 1e-5));
  EXPECT_NEAR(ours, peer, 1e-3 * peer);
  EXPECT_NEAR(found.projector.fx, K.at<double>(0, 0), 0.05);
  EXPECT_NEAR(found.projector.cy, K.at<double>(1, 2), 0.05);
  EXPECT_NEAR(found.T_projector_camera.translation().y(), t[0].at<double>(1), 0.05);
}

TEST(RigBundle, IsAMinimumInEveryParameter) {
  const Problem problem = make_problem(0.2);
  const Bundle found = refine_bundle(problem.truth, problem.views, {});
  const double least = total_squares(found, problem.views);
  const auto grows = [&](auto change) {
    for (const double step : {-1.0, 1.0}) {
      Bundle other = found;
      change(other, step);
      if (!(total_squares(other, problem.views) > least)) return false;
    }
    return true;
  };
  EXPECT_TRUE(grows([](Bundle& b, double step) { b.camera.fx += 1e-2 * step; }));
  EXPECT_TRUE(grows([](Bundle& b, double step) { b.camera.cy += 1e-2 * step; }));
  EXPECT_TRUE(grows([](Bundle& b, double step) { b.camera.distortion[0] += 1e-4 * step; }));
  EXPECT_TRUE(grows([](Bundle& b, double step) { b.projector.fy += 1e-2 * step; }));
  EXPECT_TRUE(grows([](Bundle& b, double step) { b.projector.distortion[3] += 1e-4 * step; }));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(grows([&](Bundle& b, double step) {
      b.T_projector_camera.prerotate(Eigen::AngleAxisd(1e-5 * step, Eigen::Vector3d::Unit(axis)));
    })) << axis;
    EXPECT_TRUE(grows([&](Bundle& b, double step) {
      b.T_camera_board[3].prerotate(Eigen::AngleAxisd(1e-5 * step, Eigen::Vector3d::Unit(axis)));
    })) << axis;
    EXPECT_TRUE(grows([&](Bundle& b, double step) {
      b.T_camera_board[1].pretranslate(1e-3 * step * Eigen::Vector3d::Unit(axis));
    })) << axis;
  }
}

TEST(RigBundle, APointWithoutWeightDoesNotCount) {
  Problem problem = make_problem(0.1);
  const Bundle without = refine_bundle(problem.truth, problem.views, {});
  BundleView& view = problem.views[2];
  view.camera.conservativeResize(Eigen::NoChange, 55);
  view.board.conservativeResize(Eigen::NoChange, 55);
  view.camera_weight.conservativeResize(55);
  view.camera.col(54) << 10, 400;
  view.board.col(54) << 0, 0;
  view.camera_weight[54] = 0;
  const Bundle with = refine_bundle(problem.truth, problem.views, {});
  EXPECT_NEAR(with.camera.fx, without.camera.fx, 1e-6);
  EXPECT_NEAR(with.projector.cy, without.projector.cy, 1e-6);
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
  const BundleOptions options{.distortion_terms = 2};
  Bundle start = problem.truth;
  start.projector.fx *= 1.02;
  const Bundle found = refine_bundle(start, problem.views, options);
  EXPECT_EQ(found.projector.distortion[2], start.projector.distortion[2]);
  EXPECT_LT(total_squares(found, problem.views), total_squares(start, problem.views));
  const Eigen::MatrixXd covariance = bundle_covariance(found, problem.views, options);
  EXPECT_EQ(covariance(15, 15), 0) << "p1 of the projector";
  EXPECT_GT(covariance(9, 9), 0);
}

}  // namespace
}  // namespace palpate::sensing
