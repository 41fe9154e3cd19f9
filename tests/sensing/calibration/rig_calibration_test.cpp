// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibration/synthetic_board.h"
#include "palpate/core/error.h"
#include "setup/rig_jacobian.h"
#include "setup/triangulation.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::StartsWith;

constexpr ImageSize kCamera{640, 480};

RigCalibration calibrate(const std::vector<RigView>& views,
                         const RigCalibrationOptions& options = {}) {
  return calibrate_rig(views, kCamera, kPanel, options);
}

void expect_rig(const Rig& found, const Rig& truth, double pixels, double lengths) {
  EXPECT_NEAR(found.camera.fx, truth.camera.fx, pixels);
  EXPECT_NEAR(found.camera.cy, truth.camera.cy, pixels);
  EXPECT_NEAR(found.projector.fy, truth.projector.fy, pixels);
  EXPECT_NEAR(found.projector.cx, truth.projector.cx, pixels);
  EXPECT_LT(
      (found.T_projector_camera.translation() - truth.T_projector_camera.translation()).norm(),
      lengths);
}

TEST(CalibrateRig, ExactPointsGiveTheExactRig) {
  const Rig truth = make_board_rig();
  const RigCalibration result = calibrate(make_views(truth, board_poses(8)));
  expect_rig(result.rig, truth, 1e-5, 1e-5);
  EXPECT_TRUE(
      result.rig.T_projector_camera.linear().isApprox(truth.T_projector_camera.linear(), 1e-8));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(result.rig.projector.distortion.at(i), truth.projector.distortion.at(i), 1e-6) << i;
  EXPECT_LT(result.stereo_rms, 1e-6);
  EXPECT_TRUE(result.rejected.empty());
  EXPECT_EQ(result.rig.camera.width, 640);
  EXPECT_EQ(result.rig.projector.height, 384);
  EXPECT_TRUE(result.views[3].T_camera_board.isApprox(board_poses(8)[3], 1e-7));
}

// A sheet of paper that lifts from its support at a corner.
TEST(CalibrateRig, SaysWhichBoardIsNotFlatAndIsHardlyMovedByIt) {
  const Rig truth = make_board_rig();
  std::vector<RigView> views = make_views(truth, board_poses(10), 0.03, 0.05);
  const auto uneven = [](const RigCalibration& result) {
    std::vector<std::string> found;
    for (const std::string& advice : result.advice)
      if (advice.find("is the board flat") != std::string::npos) found.push_back(advice);
    return found;
  };
  EXPECT_TRUE(uneven(calibrate(views)).empty());
  for (const int corner : {0, 1, 2, 9, 10, 18}) views[4].camera.col(corner).y() += 0.8;
  const RigCalibration result = calibrate(views);
  ASSERT_EQ(uneven(result).size(), 1U);
  EXPECT_EQ(uneven(result)[0].find("view 4: 6 of 54 corners"), 0U) << uneven(result)[0];
  EXPECT_LT(std::abs(result.rig.camera.fx - truth.camera.fx), 4 * result.camera_deviation.fx);
  EXPECT_LT(std::abs(result.rig.projector.fy - truth.projector.fy),
            4 * result.projector_deviation.fy);
}

TEST(CalibrateRig, ErrorsAndResidualsAreWhatTheNoiseMakesThem) {
  const Rig truth = make_board_rig();
  const auto squared = [](double value) { return value * value; };
  double sum = 0;
  double count = 0;
  constexpr int kRuns = 8;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const RigCalibration result = calibrate(make_views(truth, board_poses(10), 0.08, 0.2, seed));
    EXPECT_NEAR(result.camera_rms, 0.08 * std::sqrt(2), 0.012);
    EXPECT_NEAR(result.projector_rms, 0.2 * std::sqrt(2), 0.03);
    const CameraDeviation& c = result.camera_deviation;
    const CameraDeviation& p = result.projector_deviation;
    const Eigen::Vector3d shift =
        result.rig.T_projector_camera.translation() - truth.T_projector_camera.translation();
    sum += squared((result.rig.camera.fx - truth.camera.fx) / c.fx) +
           squared((result.rig.camera.cx - truth.camera.cx) / c.cx) +
           squared((result.rig.projector.fy - truth.projector.fy) / p.fy) +
           squared((result.rig.projector.cy - truth.projector.cy) / p.cy) +
           squared((result.rig.projector.distortion[2] - truth.projector.distortion[2]) /
                   p.distortion[2]) +
           shift.cwiseQuotient(result.translation_deviation).squaredNorm();
    count += 8;
    EXPECT_LT(std::abs(result.rig.camera.fx / truth.camera.fx - 1), 0.005);
  }
  // Correlated within a run: the mean of 8 runs lies in this band unless the deviations are wrong.
  EXPECT_GT(std::sqrt(sum / count), 0.6);
  EXPECT_LT(std::sqrt(sum / count), 1.5);
}

TEST(CalibrateRig, LitPointsMayBeNoisyInTheCamera) {
  // Like those of a still image.
  const Rig truth = make_board_rig();
  std::vector<RigView> views = make_views(truth, board_poses(10), 0.05, 0);
  std::mt19937 random(7);
  for (RigView& view : views) add_noise(view.lit_camera, 0.05, random);
  const RigCalibration result = calibrate(views);
  EXPECT_NEAR(result.rig.projector.fx, truth.projector.fx, 5 * result.projector_deviation.fx);
  EXPECT_LT(
      (result.rig.T_projector_camera.translation() - truth.T_projector_camera.translation()).norm(),
      3);
}

TEST(CalibrateRig, WrongPointsDoNotMoveTheRig) {
  const Rig truth = make_board_rig();
  std::vector<RigView> views = make_views(truth, board_poses(10), 0.08, 0.1);
  const RigCalibration clean = calibrate(views);
  for (std::size_t v = 0; v < 5; ++v) {
    views[v].camera.col(7 * static_cast<Eigen::Index>(v)).x() += 1;  // a reflection on the corner
    views[v].projector.col(9 * static_cast<Eigen::Index>(v)).y() -= 2;  // a wrong code
  }
  const RigCalibration result = calibrate(views);
  EXPECT_TRUE(result.rejected.empty());
  EXPECT_NEAR(result.rig.camera.fx, clean.rig.camera.fx, clean.camera_deviation.fx);
  EXPECT_NEAR(result.rig.projector.cy, clean.rig.projector.cy, clean.projector_deviation.cy);
  EXPECT_NEAR(result.camera_deviation.fx, clean.camera_deviation.fx,
              0.2 * clean.camera_deviation.fx);
}

TEST(CalibrateRig, DepthsAreAsFarOffAsTheCovarianceSays) {
  const Rig truth = make_board_rig();
  const Triangulation exact(truth);
  double sum = 0;
  double count = 0;
  for (unsigned seed = 11; seed < 19; ++seed) {
    const RigCalibration result = calibrate(make_views(truth, board_poses(10), 0.08, 0.1, seed));
    const Triangulation found(result.rig);
    for (const double z : {430.0, 480.0}) {
      for (const double u : {120.0, 320.0, 520.0}) {
        for (const double v : {140.0, 240.0, 340.0}) {
          const Eigen::Vector2d pixel(u, v);
          const double lit_by =
              exact.project(exact.direction(geometry::undistort(truth.camera, pixel)), z).y();
          const double depth = found.depth(
              found.direction(geometry::undistort(result.rig.camera, pixel)), Axis::y, lit_by);
          const PanelView view =
              panel_view(result.rig, Axis::y, look_back(result.rig.camera, pixel),
                         Eigen::VectorXd::Constant(1, 1 / z));
          const double sigma = std::sqrt(inverse_depth_variance(result.rig, view)[0]) * z * z;
          sum += (depth - z) * (depth - z) / (sigma * sigma);
          count += 1;
        }
      }
    }
  }
  // Few independent errors in each of 8 runs.
  EXPECT_GT(std::sqrt(sum / count), 0.6);
  EXPECT_LT(std::sqrt(sum / count), 1.5);
}

TEST(CalibrateRig, SaysWhatTheViewsDetermineBadlyAndWhatToAdd) {
  const Rig truth = make_board_rig();
  const auto says = [&](const std::vector<Eigen::Isometry3d>& poses, const std::string& what,
                        const std::string& next) {
    for (const std::string& advice : calibrate(make_views(truth, poses, 0.05, 0.05)).advice) {
      if (advice.find(what) == 0 && advice.find(next) != std::string::npos) return true;
    }
    return false;
  };
  std::vector<Eigen::Isometry3d> level = board_poses(8);
  for (Eigen::Isometry3d& pose : level) {
    const Eigen::Vector3d middle =
        pose * Eigen::Vector3d(4 * kPrinted.square, 2.5 * kPrinted.square, 0);
    pose.pretranslate(Eigen::Vector3d(0, 0, 450 - middle.z()));
  }
  EXPECT_TRUE(says(level, "distance: all boards lie between", "farthest distance"));
  EXPECT_FALSE(says(board_poses(8), "distance", ""));
  std::vector<Eigen::Isometry3d> far = board_poses(8);
  for (Eigen::Isometry3d& pose : far) pose.pretranslate(Eigen::Vector3d(0, 0, 500));
  EXPECT_TRUE(says(far, "camera: no board lies beyond", "near all four corners"));
  EXPECT_TRUE(says(board_poses(8, 0.12), "camera: the focal length", "tilted by 30 to 45 degrees"));
}

TEST(CalibrateRig, OrderOfViewsDoesNotMatter) {
  const Rig truth = make_board_rig();
  std::vector<RigView> views = make_views(truth, board_poses(7), 0.1, 0.2);
  const Rig forwards = calibrate(views).rig;
  std::reverse(views.begin(), views.end());
  expect_rig(calibrate(views).rig, forwards, 1e-4, 1e-4);
}

TEST(CalibrateRig, TheSizeOfTheBoardIsTheSizeOfTheWorld) {
  const Rig truth = make_board_rig();
  std::vector<RigView> views = make_views(truth, board_poses(7), 0.1, 0.2);
  const Eigen::Vector3d t = calibrate(views).rig.T_projector_camera.translation();
  for (RigView& view : views) view.board *= 2;
  EXPECT_LT((calibrate(views).rig.T_projector_camera.translation() - 2 * t).norm(), 1e-3);
}

TEST(CalibrateRig, AnOutlierIsRejectedWithItsReason) {
  const Rig truth = make_board_rig();
  std::vector<RigView> views = make_views(truth, board_poses(9), 0.08, 0.15);
  const Rig without = calibrate({views.begin() + 1, views.end()}).rig;
  views[0].projector.row(0) += 0.05 * views[0].projector.row(1);  // the rig was moved
  const RigCalibration result = calibrate(views);
  ASSERT_EQ(result.rejected.size(), 1U);
  EXPECT_EQ(result.rejected[0].name, "view 0");
  EXPECT_NE(result.rejected[0].reason.find("outlier"), std::string::npos);
  EXPECT_EQ(result.views.size(), 8U);
  expect_rig(result.rig, without, 1e-6, 1e-6);
}

/// Views of which those from `after` on were taken with the projector turned by `degrees`.
std::vector<RigView> knocked(std::size_t count, std::size_t after, double degrees) {
  const Rig before = make_board_rig();
  Rig knocked = before;
  knocked.T_projector_camera.prerotate(
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d(2, -1, 2).normalized()));
  const auto poses = board_poses(static_cast<int>(count));
  std::vector<RigView> views = make_views(before, poses, 0.02, 0.05);
  const std::vector<RigView> moved = make_views(knocked, poses, 0.02, 0.05);
  std::copy(moved.begin() + static_cast<std::ptrdiff_t>(after), moved.end(),
            views.begin() + static_cast<std::ptrdiff_t>(after));
  return views;
}

TEST(CalibrateRig, SaysAfterWhichViewTheProjectorWasKnocked) {
  struct Case {
    std::size_t views, after;
    double degrees;
  };
  for (const Case& knock :
       {Case{12, 6, 0.3}, {12, 6, 0.03}, {12, 3, 0.3}, {12, 9, 2}, {8, 4, 0.1}}) {
    const std::string message = message_of<SolverError>(
        [&] { (void)calibrate(knocked(knock.views, knock.after, knock.degrees)); });
    EXPECT_NE(
        message.find("moved against each other between view " + std::to_string(knock.after - 1) +
                     " and view " + std::to_string(knock.after) + ":"),
        std::string::npos)
        << knock.views << ' ' << knock.after << ' ' << knock.degrees << ": " << message;
  }
}

TEST(CalibrateRig, ViewsWithoutEnoughPointsAreRejectedWithTheirReason) {
  std::vector<RigView> views = make_views(make_board_rig(), board_poses(7));
  views[1] = RigView{.name = "dark"};
  views[4].lit_camera.conservativeResize(Eigen::NoChange, 5);
  views[4].projector.conservativeResize(Eigen::NoChange, 5);
  const RigCalibration result = calibrate(views);
  ASSERT_EQ(result.rejected.size(), 2U);
  EXPECT_NE(result.rejected[0].reason.find("board was not found"), std::string::npos);
  EXPECT_NE(result.rejected[1].reason.find("only 5"), std::string::npos);
  expect_rig(result.rig, make_board_rig(), 1e-4, 1e-4);
}

TEST(CalibrateRig, ParallelBoardsAreRefused) {
  const auto refusal = [](double sigma, double tilt, int terms) {
    return message_of<SolverError>([&] {
      (void)calibrate(make_views(make_board_rig(), board_poses(6, tilt), sigma, sigma),
                      {.distortion_terms = terms});
    });
  };
  const std::string next_step = "tilted by 20 to 45 degrees";
  struct Case {
    double sigma, tilt;
    int terms;
  };
  for (const auto& [sigma, tilt, terms] :
       {Case{0, 0, 0}, {0.1, 0, 2}, {0, 0.02, 4}, {0.1, 0.02, 0}})
    EXPECT_NE(refusal(sigma, tilt, terms).find(next_step), std::string::npos)
        << sigma << ' ' << tilt;
  EXPECT_TRUE(refusal(0.1, 0.4, 4).empty());
}

TEST(CalibrateRig, FewerThanThreeViewsAreRefusedWithTheReasonsOfTheOthers) {
  std::vector<RigView> views = make_views(make_board_rig(), board_poses(3));
  views[2] = RigView{.name = "dark"};
  const std::string message = message_of<SolverError>([&] { (void)calibrate(views); });
  EXPECT_NE(message.find("2 views"), std::string::npos) << message;
  EXPECT_NE(message.find("dark: the printed board was not found"), std::string::npos) << message;
  EXPECT_THROW((void)calibrate({}), SolverError);
}

TEST(CalibrateRig, RefusesWrongInput) {
  const std::vector<RigView> views = make_views(make_board_rig(), board_poses(5));
  const auto expect_refused = [&](auto change) {
    std::vector<RigView> wrong = views;
    change(wrong[3]);
    EXPECT_THAT(message_of<InvalidInput>([&] { (void)calibrate(wrong); }),
                StartsWith("calibrate_rig"));
  };
  expect_refused([](RigView& view) { view.camera(0, 7) = std::nan(""); });
  expect_refused([](RigView& view) { view.camera.conservativeResize(Eigen::NoChange, 20); });
  expect_refused([](RigView& view) { view.projector.conservativeResize(Eigen::NoChange, 20); });
  expect_refused([](RigView& view) { view.lit_camera(1, 3) = std::nan(""); });
  EXPECT_THROW((void)calibrate(views, {.distortion_terms = 3}), InvalidInput);
  EXPECT_THROW((void)calibrate(views, {.max_residual_ratio = std::nan("")}), InvalidInput);
  EXPECT_THROW((void)calibrate(views, {.max_focal_deviation = 0}), InvalidInput);
  EXPECT_THROW((void)calibrate(views, {.min_tilt = std::nan("")}), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
