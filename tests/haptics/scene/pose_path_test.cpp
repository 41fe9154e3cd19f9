// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/pose_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "haptics_testing.h"
#include "not_finite.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

Eigen::Isometry3d turned(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_exp(rotation);
  pose.translation() = translation;
  return pose;
}

TEST(PosePath, MovesAndTurnsEvenlyBetweenItsPosesAndStandsStillBeyond) {
  const Eigen::Isometry3d from = turned({0.3, -1, 0.2}, {1, 2, 3});
  // A turn by 2 rad about one axis of the world.
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3;
  Eigen::Isometry3d to = from;
  to.linear() = rotation_exp(2 * axis) * from.linear();
  to.translation() << 5, 2, -5;
  const PosePath path({{10, from}, {14, to}});
  EXPECT_EQ(path.pose(3).matrix(), from.matrix());
  EXPECT_EQ(path.pose(10).matrix(), from.matrix());
  EXPECT_EQ(path.pose(14).matrix(), to.matrix());
  EXPECT_EQ(path.pose(99).matrix(), to.matrix());
  EXPECT_EQ(path.pose(kNaN).matrix(), from.matrix());
  const Eigen::Isometry3d quarter = path.pose(11);
  EXPECT_LT((quarter.linear() - rotation_exp(0.5 * axis) * from.linear()).norm(), 1e-12);
  EXPECT_LT((quarter.translation() - Eigen::Vector3d(2, 2, 1)).norm(), 1e-12);
}

TEST(PosePath, RefusesPosesThatAreNotRigidAndTimesThatDoNotIncrease) {
  const PosePoint good{1, turned({1, 0, 0}, {1, 2, 3})};
  const auto refused = [](std::vector<PosePoint> points) {
    return refusal([&] { return PosePath(std::move(points)); });
  };
  EXPECT_THAT(refused({}), HasSubstr("there is no pose"));
  PosePoint wrong = good;
  wrong.T_world_object.linear() *= 1.001;
  EXPECT_THAT(refused({good, wrong}), HasSubstr("pose 1 is not later"));
  wrong.time = 2;
  EXPECT_THAT(refused({good, wrong}), HasSubstr("pose 1 is no rigid motion"));
  wrong = {2, good.T_world_object};
  wrong.T_world_object.translation().y() = kNaN;
  EXPECT_THAT(refused({good, wrong}), HasSubstr("pose 1 is no rigid motion"));
  EXPECT_THAT(refused({{kInf, good.T_world_object}}), HasSubstr("not finite"));
}

TEST(PosePath, IsReadFromACsvFileOfQuaternions) {
  const ScratchFolder scratch;
  const std::string file = scratch / "path.csv";
  const auto write = [&](const std::string& rows) {
    std::ofstream(file) << "t,x,y,z,qw,qx,qy,qz\n" << rows;
  };
  // A quarter turn about z, which maps x to y.
  write("0,1,2,3,1,0,0,0\n0.5,4,5,6,0.70710678118654757,0,0,0.70710678118654757\n");
  const Eigen::Isometry3d pose = read_pose_path(file).pose(1);
  EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(4, 6, 6)).norm(), 1e-12);
  EXPECT_LT((pose * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(3, 5, 6)).norm(), 1e-12);

  const auto refused = [&](const std::string& rows) {
    write(rows);
    return refusal([&] { return read_pose_path(file); });
  };
  EXPECT_THAT(refused(""), HasSubstr("no line of numbers"));
  EXPECT_THAT(refused("0,1,2,3,0.9,0,0,0\n"), HasSubstr("line 2: the quaternion"));
  EXPECT_THAT(refused("0,1,2,3,1,0,0,0\n0,1,2,3,1,0,0,0\n"),
              HasSubstr("line 3, column 't': the time is not later"));
  EXPECT_THAT(refused("0,1,2,nan,1,0,0,0\n"), HasSubstr("column 'z'"));
}

}  // namespace
}  // namespace palpate::haptics
