// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/trajectory_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(TrajectoryCsv, ReadsTrajectories) {
  const ScratchFolder folder;
  write_text(folder / "t.csv", "x,y,z,t\n1,2,3,0\n4,5,6,0.5\n");
  const std::vector<TrajectoryPoint> trajectory = read_trajectory(folder / "t.csv");
  ASSERT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(trajectory[1].time, 0.5);
  EXPECT_EQ(trajectory[1].tool, Eigen::Vector3d(4, 5, 6));
}

TEST(TrajectoryCsv, RefusesEmptyTablesAndTimesOutOfOrder) {
  const ScratchFolder folder;
  write_text(folder / "t.csv", "t,x,y,z\n");
  EXPECT_THAT(refusal([&] { return read_trajectory(folder / "t.csv"); }),
              HasSubstr("no line of numbers"));
  write_text(folder / "t.csv", "t,x,y,z\n0,1,2,3\n1,1,2,3\n1,1,2,3\n");
  EXPECT_THAT(refusal([&] { return read_trajectory(folder / "t.csv"); }),
              AllOf(HasSubstr("line 4"), HasSubstr("'t'")));
  write_text(folder / "t.csv", "t,x,y,z\n0,1,nan,3\n");
  EXPECT_THAT(refusal([&] { return read_trajectory(folder / "t.csv"); }),
              AllOf(HasSubstr("line 2"), HasSubstr("'y'")));
}

TEST(TrajectoryCsv, WritesTheTraceToTheLastDigit) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "trace.csv";
  const std::vector<TracePoint> trace = {
      {0, {1, 2, 3}, {4, 5, 6}, {0.1, -1e-300, 0}, ContactState::stick},
      {0.001, {1, 2, 3}, {1, 2, 3}, {0, 0, 0}, ContactState::free},
      {0.002, {1, 2, 3}, {1, 2, 3}, {0, 0, 0}, ContactState::slip}};
  write_trace(path, trace);
  EXPECT_EQ(read_text(path),
            "t,x,y,z,cx,cy,cz,fx,fy,fz,state\n"
            "0,1,2,3,4,5,6,0.1,-1e-300,0,stick\n"
            "0.001,1,2,3,1,2,3,0,0,0,free\n"
            "0.002,1,2,3,1,2,3,0,0,0,slip\n");
}

}  // namespace
}  // namespace palpate::haptics
