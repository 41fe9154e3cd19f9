// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_joint_torques.h"

#include <gtest/gtest.h>

#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Within the axes, whose left end depends on the numbers by a few pixels.
const Region kTorques(110, 140, 1050, 470);

/// 15 angles up and down: gravity of 100 N mm at most, friction of 30 N mm.
JointTorques swung_joint() {
  JointTorques joint{Eigen::VectorXd(30), Eigen::VectorXd(30), Eigen::VectorXi(30),
                     Eigen::VectorXd(30), 30};
  for (int i = 0; i < 30; ++i) {
    joint.angles(i) = -28 + 4 * (i < 15 ? i : 29 - i);
    joint.directions(i) = i < 15 ? 1 : -1;
    joint.gravity(i) = 100 * std::cos(joint.angles(i) * 0.0174533);
    joint.torques(i) = joint.gravity(i) + 30 * joint.directions(i);
  }
  return joint;
}

cv::Mat3b torque_picture(const JointTorques& joint) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_joint_torques(png, joint, "Joint 1"); });
}

TEST(DrawJointTorques, DrawsTheDirectionsByTheFrictionAboveAndBelowTheLine) {
  const cv::Mat3b picture = torque_picture(swung_joint());
  EXPECT_EQ(picture.size(), cv::Size(1200, 700));
  const auto height = [&](const Rgb& color) {
    return center_of(mask_of(picture, color, 40, kTorques)).y();
  };
  const double up = height(kBlue), down = height(kVermilion), line = height(kBlack);
  EXPECT_LT(up, line - 100);
  EXPECT_NEAR(down - line, line - up, 12);
}

TEST(DrawJointTorques, PutsWhatIsCorrectedOntoTheLineIffTheFrictionIsRight) {
  JointTorques joint = swung_joint();
  // Marks on the line are two rows that coincide.
  const auto rows = [&] {
    return box_of(mask_of(torque_picture(joint), kGrey, 25, kTorques)).height;
  };
  const int right = rows();
  joint.friction = 10;
  EXPECT_GT(rows(), right + 60);
}

TEST(DrawJointTorques, RefusesInputThatDoesNotFit) {
  JointTorques joint = swung_joint();
  const auto attempt = [&joint](const std::filesystem::path& png) {
    draw_joint_torques(png, joint, "");
  };
  joint.directions(4) = 0;
  expect_refused(attempt, "directions: pose 4 is 0: 1 or -1 is needed");
  joint = swung_joint();
  joint.torques(2) = std::nan("");
  expect_refused(attempt, "torques: pose 2 is nan N mm");
  joint.gravity.conservativeResize(7);
  expect_refused(attempt, "gravity: has 7 entries where 30 are needed");
  joint = {};
  expect_refused(attempt, "angles: is empty");
}

TEST(DrawJointTorques, SaysWhenItCannotWrite) {
  expect_unwritable(
      [](const std::filesystem::path& png) { draw_joint_torques(png, swung_joint(), ""); });
}

}  // namespace
}  // namespace palpate::pictures
