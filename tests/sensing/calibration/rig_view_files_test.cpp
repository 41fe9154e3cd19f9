// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_view_files.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "calibration/synthetic_board.h"
#include "palpate/core/error.h"
#include "palpate/sensing/gray_code.h"
#include "palpate/sensing/rig_calibration.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// Photographs of one pose in a folder; the names count without leading zeros.
void write_pose(const std::filesystem::path& folder, const std::vector<cv::Mat>& photos,
                const std::string& extension) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < photos.size(); ++i)
    cv::imwrite((folder / ("shot" + std::to_string(i) + extension)).string(), photos[i]);
}

TEST(RigViewFiles, FoldersOfImagesBecomeARig) {
  const ScratchFolder folder;
  const Rig truth = make_board_rig();
  const std::vector<Eigen::Isometry3d> poses = board_poses(4);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    write_pose(folder / ("pose" + std::to_string(8 + i)),
               photograph(truth, poses[i], draw_gray_code(kPanel), static_cast<unsigned>(i)),
               i == 0 ? ".jpg" : ".png");
  }
  write_text(folder / "notes.txt", "no pose");
  int calls = 0;
  const RigViewFiles files =
      read_rig_views({folder.path()}, kPrinted, kPanel, {}, [&](int done, int total) {
        EXPECT_EQ(done, ++calls);
        EXPECT_EQ(total, 4);
      });
  EXPECT_EQ(calls, 4);
  EXPECT_EQ(files.camera.width, 640);
  ASSERT_EQ(files.views.size(), 4U);
  EXPECT_EQ(files.views[1].name, "pose9");
  EXPECT_EQ(files.views[2].name, "pose10");
  const RigCalibration result =
      calibrate_rig(files.views, files.camera, kPanel, {.distortion_terms = 2});
  EXPECT_EQ(result.views.size(), 4U);
  EXPECT_LT(result.camera_rms, 0.15);
  EXPECT_LT(result.projector_rms, 0.15);
  EXPECT_NEAR(result.rig.camera.fx, truth.camera.fx, 0.01 * truth.camera.fx);
  EXPECT_NEAR(result.rig.projector.fx, truth.projector.fx, 0.01 * truth.projector.fx);
  // The purpose of a rig: points a metre away, triangulated, would be off by no more than this.
  EXPECT_LT(
      (result.rig.T_projector_camera.translation() - truth.T_projector_camera.translation()).norm(),
      10);
}

TEST(RigViewFiles, FoldersOfChArUcoImagesBecomeARigAlsoWhereThePictureEndsInTheBoard) {
  const ScratchFolder folder;
  Rig truth = make_board_rig();
  truth.projector = {.width = 512, .height = 384, .fx = 450, .fy = 450, .cx = 280, .cy = 200};
  const Board board{.columns = 9, .rows = 6, .square = 15.5, .marker = 11.5};
  std::vector<Eigen::Isometry3d> poses = board_poses(5);
  poses[1].pretranslate(Eigen::Vector3d(-150, 0, 0));
  poses[3].pretranslate(Eigen::Vector3d(150, 40, 0));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    write_pose(folder / ("pose" + std::to_string(i)),
               photograph(truth, poses[i], draw_gray_code(kPanel), static_cast<unsigned>(i),
                          print_of(board)),
               ".png");
  }
  const RigViewFiles files = read_rig_views({folder.path()}, board, kPanel);
  ASSERT_EQ(files.views.size(), 5U);
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_EQ(files.views[i].camera.cols() < 54, i % 2 == 1) << i;
  const RigCalibration result =
      calibrate_rig(files.views, files.camera, kPanel, {.distortion_terms = 2});
  EXPECT_EQ(result.views.size(), 5U);
  EXPECT_LT(result.camera_rms, 0.15);
  EXPECT_LT(result.projector_rms, 0.15);
  EXPECT_NEAR(result.rig.camera.fx, truth.camera.fx, 0.005 * truth.camera.fx);
  EXPECT_NEAR(result.rig.projector.fx, truth.projector.fx, 0.005 * truth.projector.fx);
  EXPECT_LT(
      (result.rig.T_projector_camera.translation() - truth.T_projector_camera.translation()).norm(),
      3);
}

TEST(RigViewFiles, ProjectorImagesAreWrittenInTheOrderTheyAreRead) {
  const ScratchFolder folder;
  const int count = write_projector_images(folder / "show", kPanel, kPrinted);
  EXPECT_EQ(count, gray_code_length(kPanel));
  const std::vector<cv::Mat> code = draw_gray_code(kPanel);
  const cv::Mat third =
      cv::imread((folder / "show/graycode_03.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(third.size(), code[3].size());
  EXPECT_EQ(cv::countNonZero(third != code[3]), 0);
  const Board still = projected_board(kPanel, kPrinted);
  EXPECT_TRUE(find_board(cv::imread((folder / "show/projected.png").string(), 0), still));
}

TEST(RigViewFiles, AStillPoseIsTwoImages) {
  const ScratchFolder folder;
  const Board board = projected_board(kPanel, kPrinted);
  const cv::Mat shown = draw_projected_board(kPanel, board);
  std::filesystem::create_directories(folder / "a");
  cv::imwrite((folder / "a/board.png").string(), cv::Mat(384, 512, CV_8U, cv::Scalar(9)));
  cv::imwrite((folder / "a/projected.png").string(), shown);
  const RigViewFiles files = read_rig_views({folder / "a"}, kPrinted, kPanel);
  ASSERT_EQ(files.views.size(), 1U);
  EXPECT_EQ(files.views[0].camera.cols(), 0);
  EXPECT_EQ(files.views[0].lit_camera.cols(), 40);
}

TEST(RigViewFiles, RefuseWhatIsNoSequence) {
  const ScratchFolder folder;
  const auto message = [&](const std::string& name) {
    return message_of<FileError>([&] { (void)read_rig_views({folder / name}, kPrinted, kPanel); });
  };
  EXPECT_NE(message("none").find("none"), std::string::npos);
  std::filesystem::create_directories(folder / "empty");
  EXPECT_NE(message("empty").find("no image"), std::string::npos);
  const cv::Mat gray(48, 64, CV_8U, cv::Scalar(9));
  write_pose(folder / "short", std::vector<cv::Mat>(5, gray), ".png");
  EXPECT_NE(message("short").find("has 38"), std::string::npos) << message("short");
  std::vector<cv::Mat> images(38, gray);
  images[20] = cv::Mat(48, 60, CV_8U, cv::Scalar(9));
  write_pose(folder / "sizes", images, ".png");
  EXPECT_NE(message("sizes").find("shot20.png"), std::string::npos);
  images[20] = gray;
  write_pose(folder / "broken", images, ".jpg");
  write_text(folder / "broken/shot7.jpg", "no image");
  EXPECT_NE(message("broken").find("shot7.jpg"), std::string::npos);
  EXPECT_THROW((void)read_rig_views({folder / "short"}, {.columns = 1}, kPanel), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
