// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/trajectory_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::haptics {
namespace {

std::vector<TrajectoryPoint> some_points() {
  std::vector<TrajectoryPoint> points;
  for (int i = 0; i < 50; ++i) points.push_back({1e-3 * i, {std::sin(i), 1.0 / 3 * i, -700}});
  return points;
}

TEST(TrajectoryFile, ReadsBackExactlyWhatWasWritten) {
  const ScratchFolder folder;
  const std::vector<TrajectoryPoint> points = some_points();
  write_binary_trajectory(folder / "path.bin", points);
  const std::vector<TrajectoryPoint> read = read_trajectory_file(folder / "path.bin");
  ASSERT_EQ(read.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(read[i].time, points[i].time);
    EXPECT_EQ(read[i].tool, points[i].tool);
  }
}

TEST(TrajectoryFile, ReadsCsvToo) {
  const ScratchFolder folder;
  write_text(folder / "path.csv", "t,x,y,z\n0,1,2,3\n0.5,4,5,6\n");
  const std::vector<TrajectoryPoint> read = read_trajectory_file(folder / "path.csv");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].tool, Eigen::Vector3d(4, 5, 6));
}

TEST(TrajectoryFile, RefusesWithThePlaceWhatIsWrong) {
  const ScratchFolder folder;
  const auto path = folder / "path.bin";
  const auto message = [&] { return refusal([&] { return read_trajectory_file(path); }); };
  std::vector<TrajectoryPoint> points = some_points();
  write_binary_trajectory(path, points);
  const std::string whole = read_text(path);
  write_text(path, whole.substr(0, whole.size() - 8));
  EXPECT_NE(message().find("ends after 49 of 50 points"), std::string::npos);
  write_text(path, replaced(whole, "\"version\":1", "\"version\":2"));
  EXPECT_NE(message().find("version 2; this program reads version 1"), std::string::npos);
  write_text(path, "{\"format\": \"another\"}\n");
  EXPECT_NE(message().find("neither a CSV file"), std::string::npos);
  write_text(path, "{\"format\": 7}\n");
  EXPECT_NE(message().find("neither a CSV file"), std::string::npos);
  points[7].tool.x() = std::nan("");
  write_binary_trajectory(path, points);
  EXPECT_NE(message().find("point 7 is not finite"), std::string::npos);
  points = some_points();
  points[9].time = points[8].time;
  write_binary_trajectory(path, points);
  EXPECT_NE(message().find("point 9 is not later"), std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
