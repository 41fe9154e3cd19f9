// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/board_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibration/synthetic_board.h"
#include "palpate/core/error.h"
#include "palpate/sensing/board_print.h"
#include "palpate/sensing/gray_code.h"

namespace palpate::sensing {
namespace {

double rms(const Eigen::Matrix2Xd& a, const Eigen::Matrix2Xd& b) {
  return std::sqrt((a - b).squaredNorm() / static_cast<double>(a.cols()));
}

TEST(BoardViews, GrayCodeFindsCornersBetweenThePixels) {
  const Rig rig = make_board_rig();
  const ImageSize panel{512, 384};
  const Eigen::Isometry3d pose = board_poses(3)[2];
  const RigView view =
      view_from_gray_code(photograph(rig, pose, draw_gray_code(panel)), kPrinted, panel);
  const RigView truth = exact_view(rig, pose, "");
  ASSERT_EQ(view.camera.cols(), 54);
  EXPECT_TRUE(view.board == truth.board);
  EXPECT_LT(rms(view.camera, truth.camera), 0.03);
  // All over the board, 130 x 90 mm of which the camera sees some 30,000 pixels, not at corners
  // only.
  ASSERT_GT(view.projector.cols(), 100);
  const Eigen::Isometry3d T_board_camera = pose.inverse();
  Eigen::Matrix2Xd lamps(2, view.projector.cols());
  for (Eigen::Index i = 0; i < lamps.cols(); ++i) {
    const Eigen::Vector3d eye = T_board_camera.translation();
    const Eigen::Vector3d ray =
        T_board_camera.linear() *
        geometry::undistort(rig.camera, view.lit_camera.col(i)).homogeneous();
    const Eigen::Vector3d point = eye - eye.z() / ray.z() * ray;
    lamps.col(i) = seen_by(rig.projector, rig.T_projector_camera * pose * point);
  }
  EXPECT_LT(rms(view.projector, lamps), 0.04);
}

TEST(BoardViews, APartOfAChessboardIsNoBoard) {
  // A wide panel, so that the light does not end on the board.
  Rig wide = make_board_rig();
  wide.projector = {.width = 512, .height = 384, .fx = 450, .fy = 450, .cx = 280, .cy = 200};
  Eigen::Isometry3d pose = board_poses(3)[2];
  pose.pretranslate(Eigen::Vector3d(-170, -25, 0));
  ASSERT_GT((exact_view(wide, pose, "").camera.row(0).array() < 0).count(), 4);
  const RigView view =
      view_from_gray_code(photograph(wide, pose, draw_gray_code(kPanel)), kPrinted, kPanel);
  EXPECT_EQ(view.camera.cols(), 0);
}

TEST(BoardViews, AChArUcoBoardTellsWhichOfItsCornersAreSeen) {
  const Rig rig = make_board_rig();
  const Board board{.columns = 9, .rows = 6, .square = 15.5, .marker = 11.5};
  Rig wide = rig;
  wide.projector = {.width = 512, .height = 384, .fx = 450, .fy = 450, .cx = 280, .cy = 200};
  for (const double aside : {0.0, -170.0}) {
    Eigen::Isometry3d pose = board_poses(3)[2];
    pose.pretranslate(Eigen::Vector3d(aside, aside / 7, 0));
    const RigView truth = exact_view(rig, pose, "");
    const RigView view = view_from_gray_code(
        photograph(wide, pose, draw_gray_code({512, 384}), 1, print_of(board)), board, {512, 384});
    EXPECT_GE(view.camera.cols(), aside == 0 ? 54 : 20);
    Eigen::Matrix2Xd expected = view.camera;
    for (Eigen::Index i = 0; i < view.board.cols(); ++i) {
      const Eigen::Vector2d point = view.board.col(i);
      expected.col(i) = seen_by(rig.camera, pose * Eigen::Vector3d(point.x(), point.y(), 0));
    }
    EXPECT_LT(rms(view.camera, expected), 0.1) << aside;
    EXPECT_GT(view.projector.cols(), 30);
  }
}

// OpenCV's boards with even counts of squares once began with a white square.
TEST(BoardViews, CornersOfChArUcoBoardsAreTheirOwnWhateverTheCounts) {
  constexpr double kScale = 2;  // px/mm
  constexpr double kFiner = 4;
  const cv::Mat nothing(100, 100, CV_8U, cv::Scalar(128));
  for (Board board : {Board{.columns = 6, .rows = 8}, Board{.columns = 6, .rows = 9},
                      Board{.columns = 7, .rows = 8}, Board{.columns = 7, .rows = 9}}) {
    board.square = 20;
    board.marker = 15;
    board.marker_bits = board.columns + board.rows - 10;  // 4, 5, 5, 6
    cv::Mat image;
    cv::resize(draw_board(board, kFiner * kScale), image, {}, 1 / kFiner, 1 / kFiner,
               cv::INTER_AREA);
    cv::GaussianBlur(image, image, {0, 0}, 0.8);
    const RigView view = view_from_still(image, nothing, board, kPanel);
    ASSERT_EQ(view.camera.cols(), board.columns * board.rows);
    Eigen::Matrix2Xd truth = view.board;
    for (Eigen::Index i = 0; i < truth.cols(); ++i)
      truth.col(i) = drawn_at(board, view.board.col(i), kScale);
    EXPECT_LT(rms(view.camera, truth), 0.03) << board.columns << " x " << board.rows;
  }
}

TEST(BoardViews, AViewWithoutABoardIsEmpty) {
  const ImageSize panel{64, 48};
  std::vector<cv::Mat> images = draw_gray_code(panel);
  for (cv::Mat& image : images) cv::resize(image, image, {320, 240});
  const RigView view = view_from_gray_code(images, kPrinted, panel);
  EXPECT_EQ(view.camera.cols(), 0);
  EXPECT_EQ(view.projector.cols(), 0);
}

TEST(BoardViews, AStillImageIsSeenBesideThePrintedBoard) {
  Rig rig = make_board_rig();
  const ImageSize panel{512, 384};
  const Board printed{.columns = 9, .rows = 6, .square = 15.5};
  const Board shown = projected_board(panel, printed);
  EXPECT_EQ(shown.columns, 8);
  EXPECT_EQ(shown.rows, 5);
  Eigen::Isometry3d pose = board_poses(1)[0];
  const cv::Mat white(384, 512, CV_8U, cv::Scalar(255));
  const std::vector<cv::Mat> photos =
      photograph(rig, pose, {white, draw_projected_board(panel, shown)});
  // A sheet of paper over the printed board: only the projected one is left.
  Eigen::Isometry3d beside = pose;
  beside.translate(Eigen::Vector3d(2000, 0, 0));
  const cv::Mat covered = photograph(rig, beside, {draw_projected_board(panel, shown)})[0];
  const RigView view = view_from_still(photos[0], covered, printed, panel);
  ASSERT_EQ(view.camera.cols(), 54);
  ASSERT_EQ(view.lit_camera.cols(), 40);
  EXPECT_TRUE(view.projector == projected_corners(panel, shown));
  // The true places of the projector's corners: on the plane of the board, seen by the camera.
  const Eigen::Isometry3d T_board_projector = (rig.T_projector_camera * pose).inverse();
  Eigen::Matrix2Xd truth(2, 40);
  for (Eigen::Index i = 0; i < 40; ++i) {
    const Eigen::Vector3d ray =
        T_board_projector.linear() *
        geometry::undistort(rig.projector, view.projector.col(i)).homogeneous();
    const Eigen::Vector3d lamp = T_board_projector.translation();
    truth.col(i) = seen_by(rig.camera, pose * (lamp - lamp.z() / ray.z() * ray).eval());
  }
  EXPECT_LT(rms(view.lit_camera, truth), 0.1);
}

TEST(BoardViews, ProjectedBoardIsFoundWhereItWasDrawn) {
  const ImageSize panel{640, 480};
  const Board board = projected_board(panel, {.columns = 7, .rows = 9, .square = 20});
  const auto found = find_board(draw_projected_board(panel, board), board);
  ASSERT_TRUE(found);
  EXPECT_LT(rms(*found, projected_corners(panel, board)), 0.05);
}

TEST(BoardViews, TheOrderOfCornersTurnsWithTheBoard) {
  const ImageSize panel{640, 480};
  const Board board = projected_board(panel, {.columns = 7, .rows = 9, .square = 20});
  const cv::Mat upright = draw_projected_board(panel, board);
  const Eigen::Matrix2Xd corners = projected_corners(panel, board);
  cv::Mat turned;
  cv::rotate(upright, turned, cv::ROTATE_180);
  auto found = find_board(turned, board);
  ASSERT_TRUE(found);
  Eigen::Matrix2Xd expected = -corners;
  expected.colwise() += Eigen::Vector2d(639, 479);
  EXPECT_LT(rms(*found, expected), 0.05);
  cv::rotate(upright, turned, cv::ROTATE_90_CLOCKWISE);
  found = find_board(turned, board);
  ASSERT_TRUE(found);
  expected.row(0) = 479 - corners.row(1).array();
  expected.row(1) = corners.row(0);
  EXPECT_LT(rms(*found, expected), 0.05);
}

TEST(BoardViews, RefuseWrongInput) {
  const cv::Mat gray(100, 100, CV_8U, cv::Scalar(128));
  EXPECT_THROW((void)board_corners({.columns = 2, .rows = 6, .square = 1}), InvalidInput);
  EXPECT_THROW((void)board_corners({.columns = 9, .rows = 6, .square = std::nan("")}),
               InvalidInput);
  EXPECT_THROW((void)find_board(gray, {.columns = 9, .rows = 6, .square = 0}), InvalidInput);
  EXPECT_THROW((void)find_board({}, kPrinted), InvalidInput);
  EXPECT_THROW((void)find_board(cv::Mat(9, 9, CV_32F, cv::Scalar(0)), kPrinted), InvalidInput);
  EXPECT_THROW((void)projected_board({60, 40}, kPrinted), InvalidInput);
  EXPECT_THROW((void)view_from_gray_code({gray}, kPrinted, {16, 16}), InvalidInput);
  EXPECT_FALSE(find_board(gray, kPrinted));
  EXPECT_THROW((void)board_patches({.columns = 9, .rows = 6, .square = 5, .marker = 5}),
               InvalidInput);
  EXPECT_THROW(
      (void)board_patches({.columns = 9, .rows = 6, .square = 5, .marker = 4, .marker_bits = 8}),
      InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
