// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/placement_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "palpate/core/error.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

using ::testing::HasSubstr;

class PlacementTables : public ::testing::Test {
 protected:
  std::filesystem::path written(const std::string& text) {
    const std::filesystem::path path = scratch_ / "table.csv";
    std::ofstream(path) << text;
    return path;
  }

 private:
  ScratchFolder scratch_;
};

TEST_F(PlacementTables, OfTouchesHaveColumnsInAnyOrder) {
  const Eigen::Matrix3Xd tips = read_touches(written("z,name,x,y\n3,a,1,2\n-6.5,b,4,5\n"));
  ASSERT_EQ(tips.cols(), 2);
  EXPECT_EQ(tips.col(0), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(tips.col(1), Eigen::Vector3d(4, 5, -6.5));
}

TEST_F(PlacementTables, OfPosesMayHaveOrientations) {
  const auto still = read_seen_poses(written("range_map,x,y,z\na.tiff,1,2,3\n"));
  ASSERT_EQ(still.size(), 1U);
  EXPECT_EQ(still[0].seen, "a.tiff");
  EXPECT_EQ(still[0].tip, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(still[0].R_base_tip);
  const auto turned =
      read_seen_poses(written("range_map,x,y,z,qx,qy,qz,qw\na.tiff,1,2,3,0,0.6,0,0.8\n"));
  ASSERT_TRUE(turned[0].R_base_tip);
  EXPECT_TRUE(turned[0].R_base_tip->isApprox(Eigen::Quaterniond(0.8, 0, 0.6, 0)));
}

TEST_F(PlacementTables, NameWhatIsWrongInThem) {
  const auto message = [&](const std::string& text) {
    return refusal([&] { (void)read_seen_poses(written(text)); });
  };
  EXPECT_THAT(message("range_map,x,y\na,1,2\n"), HasSubstr("'z'"));
  EXPECT_THAT(message("range_map,x,y,z\n"), HasSubstr("has no poses"));
  EXPECT_THAT(message("range_map,x,y,z\n,1,2,3\n"), HasSubstr("line 2: 'range_map' is empty"));
  EXPECT_THAT(message("range_map,x,y,z\na,1,2,nan\n"), HasSubstr("line 2"));
  EXPECT_THAT(message("range_map,x,y,z,qx,qy,qz,qw\na,1,2,3,1,0,0,1\n"),
              HasSubstr("length 1.414213562373095"));
  EXPECT_THAT(message("range_map,x,y,z,qx,qy,qz,qw\na,1,2,3,1,0,0,0\nb,1,2,4,0,0,0,0\n"),
              HasSubstr("only some lines"));
  EXPECT_THAT(refusal([&] { (void)read_touches(written("x,y,z\n")); }), HasSubstr("no touches"));
}

}  // namespace
}  // namespace palpate::probing
