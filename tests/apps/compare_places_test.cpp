// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate compare` doubts surfaces that cannot be two of one object.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "mesh_corpus.h"
#include "palpate/geometry/mesh_io.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// z = x^2 / (2 radius) over 100 x 100 mm, in strips of a width along x.
geometry::TriangleMesh gutter(double radius, double width) {
  geometry::TriangleMesh mesh;
  const auto strips = static_cast<Eigen::Index>(std::lround(100 / width));
  mesh.vertices.resize(3, 2 * (strips + 1));
  mesh.triangles.resize(3, 2 * strips);
  for (Eigen::Index i = 0; i <= strips; ++i) {
    const double x = static_cast<double>(i) * width - 50;
    mesh.vertices.col(2 * i) << x, -50, x * x / (2 * radius);
    mesh.vertices.col(2 * i + 1) << x, 50, x * x / (2 * radius);
  }
  for (int i = 0; i < strips; ++i) {
    mesh.triangles.col(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
    mesh.triangles.col(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
  }
  return mesh;
}

class ComparePlaces : public ::testing::Test {
 protected:
  CommandResult compare(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b) {
    geometry::write_mesh(scratch / "a.ply", a);
    geometry::write_mesh(scratch / "b.ply", b);
    return run_palpate({"compare", scratch / "a.ply", scratch / "b.ply"});
  }

  geometry::TriangleMesh surface = geometry::test::bumpy(2000);
  ScratchFolder scratch;
};

TEST_F(ComparePlaces, OtherUnitsAndOtherFramesAreDoubted) {
  EXPECT_THAT(compare(surface, surface).err, Not(HasSubstr("same unit")));
  geometry::TriangleMesh metres = surface;
  metres.vertices /= 1000;
  EXPECT_THAT(compare(metres, surface).err, HasSubstr("same unit (--unit) and frame?"));
  EXPECT_THAT(compare(surface, metres).err, HasSubstr("same unit (--unit) and frame?"));
  geometry::TriangleMesh elsewhere = surface;
  elsewhere.vertices.row(2).array() += 5000;
  EXPECT_THAT(compare(elsewhere, surface).err, HasSubstr("mm apart or more"));
}

TEST_F(ComparePlaces, ObjectsThatDoNotTouchAreDoubted) {
  geometry::TriangleMesh beside = surface;
  const double width = surface.vertices.row(0).maxCoeff() - surface.vertices.row(0).minCoeff();
  beside.vertices.row(0).array() += 1.5 * width;
  EXPECT_THAT(compare(beside, surface).err, HasSubstr("mm apart or more"));
}

// All vertices of the coarse surface lie on the fine one, and between them its chords do not: their
// distance from the curve is s (1 - t^2) for t from -1 to 1, with s = width^2 / (8 radius).
TEST_F(ComparePlaces, ASurfaceIsNotOnlyItsVertices) {
  constexpr double kRadius = 400, kStrip = 10;
  const CommandResult result = compare(gutter(kRadius, kStrip), gutter(kRadius, kStrip / 20));
  EXPECT_TRUE(result.out.starts_with("Distance of A's surface from B's, over its area: RMS 0.023"))
      << result.out;
  const CommandResult in_json =
      run_palpate({"compare", scratch / "a.ply", scratch / "b.ply", "--json"});
  const auto figures = nlohmann::json::parse(in_json.out);
  const double rms = kStrip * kStrip / (8 * kRadius) * std::sqrt(8.0 / 15);
  constexpr double kOfTheSlope = 0.02;  // distances are along the normal, not along z
  for (const nlohmann::json& part : {figures, figures.at("in_both")})
    EXPECT_NEAR(part.at("rms").get<double>(), rms, kOfTheSlope * rms);
  EXPECT_NEAR(figures.at("in_both").at("share").get<double>(), 1, 0.02);  // not at the border
}

TEST_F(ComparePlaces, ASurfaceWithoutAreaIsNamed) {
  geometry::TriangleMesh line = surface;
  line.vertices.bottomRows(2).setZero();
  const CommandResult result = compare(line, surface);
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_THAT(result.err, HasSubstr("a.ply: its triangles have no area"));
}

}  // namespace
}  // namespace palpate::apps
