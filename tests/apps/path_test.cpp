// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate path`: on a flat sheet, round a torus, and between parts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/geometry/mesh_io.h"
#include "run_palpate.h"
#include "test_surfaces.h"

namespace palpate::apps {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Path : public ::testing::Test {
 protected:
  void SetUp() override {
    geometry::write_mesh(scratch / "sheet.ply", geometry::test::flat_sheet(20, 20, 1));
    geometry::write_mesh(scratch / "torus.ply", geometry::test::torus(48, 16, 20, 5));
  }

  /// Rows of path.csv.
  std::vector<std::vector<double>> rows() const {
    std::ifstream file(scratch / "path.csv");
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, "path,x,y,z,triangle,b0,b1,b2");
    std::vector<std::vector<double>> all;
    while (std::getline(file, line)) {
      std::istringstream cells(line);
      std::vector<double> row;
      for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
      all.push_back(row);
    }
    return all;
  }

  ScratchFolder scratch;
};

TEST_F(Path, ATriangleWithoutAreaIsNamedWithTheRemedy) {
  geometry::TriangleMesh mesh = geometry::test::flat_sheet(20, 20, 1);
  mesh.triangles.conservativeResize(Eigen::NoChange, mesh.triangles.cols() + 1);
  mesh.triangles.rightCols(1) << 0, 1, 2;  // in one line
  geometry::write_mesh(scratch / "needle.ply", mesh);
  const std::vector<std::string> call = {
      "path", scratch / "needle.ply", "--from", "1,2,0", "--to", "13,7,0",
      "-o",   scratch / "path.csv"};
  const CommandResult refused = run_palpate(call);
  EXPECT_EQ(refused.status, kWrongCall);
  EXPECT_THAT(refused.err, HasSubstr("needle.ply: triangle " +
                                     std::to_string(mesh.triangles.cols() - 1) + " has no area"));
  EXPECT_THAT(refused.err, HasSubstr("--repair"));
  EXPECT_EQ(refused.err.find("::"), std::string::npos) << refused.err;
}

TEST_F(Path, OnAFlatSheetIsTheStraightLineToEachPlace) {
  const CommandResult result =
      run_palpate({"path", scratch / "sheet.ply", "--from", "1,2,0.5", "--to", "13,7,0", "--to",
                   "1,18,-0.25", "-o", scratch / "path.csv", "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const json figures = json::parse(result.out);
  EXPECT_NEAR(figures["paths"][0]["length"].get<double>(), 13, 1e-9);
  EXPECT_NEAR(figures["paths"][1]["length"].get<double>(), 16, 1e-9);
  EXPECT_NEAR(figures["moved"].get<double>(), 0.5, 1e-12);
  const auto points = rows();
  EXPECT_EQ(points.size(), figures["paths"][0]["points"].get<std::size_t>() +
                               figures["paths"][1]["points"].get<std::size_t>());
  for (const auto& row : points) {
    ASSERT_EQ(row.size(), 8U);
    EXPECT_NEAR(row[0] == 0 ? 5 * (row[1] - 1) - 12 * (row[2] - 2) : row[1] - 1, 0, 1e-9);
    EXPECT_NEAR(row[5] + row[6] + row[7], 1, 1e-12);
  }
}

TEST_F(Path, IsPulledTightOnTheSideThatItWasLaid) {
  const std::vector<std::string> way = {"--from", "25,0,0",  "--via", "0,25,0",
                                        "--via",  "-25,0,0", "--via", "0,-25,0",
                                        "--to",   "25,0,0",  "-o",    scratch / "path.csv"};
  std::vector<std::string> call = {"path", scratch / "torus.ply", "--json"};
  call.insert(call.end(), way.begin(), way.end());
  const CommandResult result = run_palpate(call);
  ASSERT_EQ(result.status, kDone) << result.err;
  const double length = json::parse(result.out)["paths"][0]["length"].get<double>();
  // Between the inner circle of the hole and the outer one on which it was laid.
  EXPECT_GT(length, 2 * std::numbers::pi * 15 * 0.99);
  EXPECT_LT(length, 2 * std::numbers::pi * 25 * 0.99);
  double turn = 0;
  const auto points = rows();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto &a = points[i - 1], &b = points[i];
    turn += std::atan2(a[1] * b[2] - a[2] * b[1], a[1] * b[1] + a[2] * b[2]);
  }
  EXPECT_NEAR(turn, 2 * std::numbers::pi, 1e-6);
}

TEST_F(Path, SaysWhichPlacesAreNotConnected) {
  geometry::TriangleMesh two = geometry::test::flat_sheet(2, 2, 1);
  const auto count = static_cast<int>(two.vertices.cols());
  two.vertices.conservativeResize(3, 2 * count);
  two.vertices.rightCols(count) =
      two.vertices.leftCols(count).colwise() + Eigen::Vector3d(10, 0, 0);
  const Eigen::Matrix3Xi one = two.triangles;
  two.triangles.resize(3, 2 * one.cols());
  two.triangles << one, one.array() + count;
  geometry::write_mesh(scratch / "two.ply", two);
  const CommandResult part = run_palpate({"path", scratch / "two.ply", "--from", "0,0,0", "--to",
                                          "2,2,0", "--to", "11,1,0", "-o", scratch / "path.csv"});
  EXPECT_EQ(part.status, kWorkFailed);
  EXPECT_THAT(part.out, HasSubstr("no path"));
  EXPECT_THAT(part.err, HasSubstr("1 of 2 paths"));
  EXPECT_FALSE(rows().empty());
  const CommandResult none = run_palpate({"path", scratch / "two.ply", "--from", "0,0,0", "--to",
                                          "11,1,0", "-o", scratch / "none.csv"});
  EXPECT_EQ(none.status, kWorkFailed);
  EXPECT_THAT(none.err, HasSubstr("not connected"));
}

TEST_F(Path, RefusesWrongCallsAndSaysWhatWouldBeRight) {
  const std::string sheet = scratch / "sheet.ply";
  const std::string csv = scratch / "path.csv";
  const auto refused = [](std::vector<std::string> call, const char* says) {
    call.insert(call.begin(), "path");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall);
    EXPECT_THAT(result.err, HasSubstr(says));
  };
  refused({sheet, "--from", "0,0", "--to", "1,1,0", "-o", csv}, "X,Y,Z");
  refused({sheet, "--from", "0,0,nan", "--to", "1,1,0", "-o", csv}, "X,Y,Z");
  refused({sheet, "--from", "0,0,0", "--to", "1,1,0", "-o", scratch / "path.ply"}, ".csv");
  refused({sheet, "--from", "0,0,0", "--to", "1,1,0", "--to", "2,1,0", "--via", "1,2,0", "-o", csv},
          "--via");
}

}  // namespace
}  // namespace palpate::apps
