// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

const std::string kOffRows = "0 0 1\n1 0 1\n1 1 1\n0 1 1000.0000000000001\n4 0 1 2 3\n3 0 2 1\n";
const std::string kOff = "OFF\n4 2 0\n" + kOffRows;

TriangleMesh read_off(const std::string& content) {
  const ScratchFolder folder;
  write_text(folder / "mesh.off", content);
  return read_mesh(folder / "mesh.off");
}

void expect_off_refused(const std::string& content, const std::string& words) {
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_off(content)), FileError, words);
}

TEST(Off, ReadsPolygonsAndKeepsDoublesAndOrder) {
  for (const std::string& content :
       {kOff, "OFF 4 2 0\n" + kOffRows, "# made by hand\nOFF # here\r\n\n4 2\r\n" + kOffRows,
        "STCNOFF\n4 2 0\n" + replaced(replaced(kOffRows, "1 0 1\n", "1 0 1 0.5 0.5 255 0 0\n"),
                                      "3 0 2 1", "3 0 2 1 0.1 0.2 0.3")}) {
    const TriangleMesh mesh = read_off(content);
    ASSERT_EQ(mesh.vertices.cols(), 4);
    EXPECT_EQ(mesh.vertices.col(1), Eigen::Vector3d(1, 0, 1));
    EXPECT_EQ(mesh.vertices(2, 3), 1000.0000000000001);
    ASSERT_EQ(mesh.triangles.cols(), 3);
    EXPECT_EQ(mesh.triangles.col(2), Eigen::Vector3i(0, 2, 1));
  }
}

TEST(Off, KeepsTheColorsAndNormalsThatItAnnounces) {
  const ScratchFolder folder;
  const auto attributes = [&](const std::string& content) {
    write_text(folder / "mesh.off", content + "3 0 1 2\n");
    return read_mesh_file(folder / "mesh.off").vertex_attributes;
  };
  const Attributes both = attributes(
      "CNOFF\n3 1 0\n0 0 0 0 0 1 255 0 7\n1 0 0 0 0.6 0.8 9 0 7\n0 1 0 0 0 1 1 1 1 # white\n");
  EXPECT_EQ(normals(both)->col(1), Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_EQ(colors(both)->col(0), Eigen::Vector4d(1, 0, 7.0 / 255, 1));
  EXPECT_TRUE(std::holds_alternative<std::vector<std::uint8_t>>(both.back().values));
  const Attributes alpha = attributes(
      "STCOFF\n3 1 0\n0 0 0 1 0 0 0.5 8 9\n1 0 0 1 0 0 0.5 8 9\n0 1 0 1 0.25 0 0.5 8 9\n");
  EXPECT_EQ(colors(alpha)->col(2), Eigen::Vector4d(1, 0.25, 0, 0.5));
  // No attributes if a vertex lacks data that the header declares.
  EXPECT_TRUE(attributes("COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0\n0 1 0 1 0 0\n").empty());
}

TEST(Off, RefusesWithThePlace) {
  expect_off_refused(replaced(kOff, "3 0 2 1", "3 0 2 4"),
                     "face 1, corner 2: there is no vertex 4");
  expect_off_refused(replaced(kOff, "3 0 2 1", "3 0 2 -1"), "there is no vertex -1");
  expect_off_refused(replaced(kOff, "3 0 2 1", "3 0 2"), "line 8: \"\" is not a number");
  expect_off_refused(replaced(kOff, "1 1 1", "1 one 1"), "line 5: \"one\" is not a number");
  expect_off_refused(replaced(kOff, "3 0 2 1\n", ""), "holds 1 of 2 faces; it is truncated");
  expect_off_refused("OFF\n4 2 0\n0 0 1\n", "holds 1 of 4 vertices");
  expect_off_refused("OFF\n", "holds 0 of 1 lines with counts");
  for (const char* magic : {"4OFF", "nOFF", "OFFSET", "a letter"})
    expect_off_refused(replaced(kOff, "OFF", magic), "first word must be OFF");
}

TEST(Off, AHugeCountTakesNoMemory) {
  expect_off_refused(replaced(kOff, "4 2 0", "18446744073709551615 2 0"),
                     "of 18446744073709551615 vertices");
  expect_off_refused(replaced(kOff, "4 2 0", "4 18446744073709551615 0"),
                     "of 18446744073709551615 faces");
  expect_off_refused(replaced(kOff, "3 0 2 1", "4000000000 0 2 1"), "ends early");
}

}  // namespace
}  // namespace palpate::geometry
