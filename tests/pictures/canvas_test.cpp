// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Effects on a picture of those before it: all are drawn in one window.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <opencv2/core.hpp>
#include <thread>
#include <vector>

#include "child_processes.h"
#include "palpate/pictures/draw_mesh.h"
#include "palpate/pictures/draw_time_line.h"
#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// A flat picture, lower than the scene.
void draw_flat(const std::filesystem::path& png) {
  draw_time_line(png, {Eigen::VectorXd::Zero(1), {TrialKind::failed}, Eigen::VectorXi::Zero(1)},
                 "Flat");
}

/// A scene in space that fills a picture.
void draw_scene(const std::filesystem::path& png) {
  draw_mesh(png, make_square({0, 0, 100}, 50, 8), "Scene");
}

TEST(Canvas, ShowsNothingOfThePictureBefore) {
  const cv::Mat3b alone = draw_picture(draw_flat);
  EXPECT_EQ(alone.size(), cv::Size(1200, 820));
  const cv::Mat3b scene = draw_picture(draw_scene);
  EXPECT_EQ(scene.size(), cv::Size(1200, 900));
  EXPECT_EQ(cv::norm(draw_picture(draw_flat), alone, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(draw_picture(draw_scene), scene, cv::NORM_INF), 0);
}

TEST(Canvas, OfAnotherThreadIsTheSame) {
  const cv::Mat3b here = draw_picture(draw_scene);
  for (int again = 0; again < 2; ++again) {
    cv::Mat3b there;
    std::thread([&] { there = draw_picture(draw_scene); }).join();
    EXPECT_EQ(cv::norm(there, here, cv::NORM_INF), 0);
  }
  EXPECT_EQ(cv::norm(draw_picture(draw_scene), here, cv::NORM_INF), 0);
}

TEST(Canvas, IsTheSameOnAnotherServer) {
  const cv::Mat3b before = draw_picture(draw_scene);
  const std::vector<pid_t> servers = child_processes();
  ASSERT_EQ(servers.size(), 1U);
  kill(servers[0], SIGKILL);
  while (!has_ended(servers[0])) std::this_thread::yield();
  EXPECT_EQ(cv::norm(draw_picture(draw_scene), before, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace palpate::pictures
