// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate motion`: values of surfaces whose motion is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "run_palpate.h"
#include "test_surfaces.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kRate = 50;     // [Hz]
constexpr double kGrowth = 0.1;  // of the length along x in a frame
constexpr double kFall = 3;      // [mm] in a frame

class Motion : public ::testing::Test {
 protected:
  // A sheet that is stretched along x, and falls. Frame 2 was lost.
  Motion() {
    fs::create_directory(scratch / "meshes");
    for (const int frame : {0, 1, 3, 4}) {
      geometry::MeshFile file;
      file.mesh = sheet;
      for (auto vertex : file.mesh.vertices.colwise()) {
        vertex.x() *= 1 + kGrowth * frame;
        vertex.z() -= kFall * frame;
      }
      geometry::set_attribute(
          file.vertex_attributes,
          {.name = "sigma_along",
           .values = std::vector<float>(static_cast<std::size_t>(sheet.vertices.cols()), 0.5F),
           .list_sizes = {}});
      geometry::write_mesh_file(scratch / ("meshes/frame_000" + std::to_string(frame) + ".ply"),
                                file);
    }
  }

  CommandResult motion(std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"motion", scratch / "meshes", "-o", scratch / "motion"});
    return run_palpate(options);
  }
  geometry::MeshFile result(const std::string& name) {
    return geometry::read_mesh_file(scratch / ("motion/" + name));
  }

  ScratchFolder scratch;
  geometry::TriangleMesh sheet = geometry::test::flat_sheet(12, 8, 5);
};

TEST_F(Motion, GivesEachVertexItsDisplacementVelocityAndStretch) {
  const CommandResult done = motion({"--rate", std::to_string(kRate), "--json"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json frames = json::parse(done.out)["per_frame"];
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_DOUBLE_EQ(frames[2]["time"], 3 / kRate);
  EXPECT_NEAR(frames[2]["stretch_max"], 1 + 3 * kGrowth, 1e-6);
  EXPECT_NEAR(frames[2]["stretch_min"], 1, 1e-6);
  EXPECT_NEAR(frames[2]["area_ratio"], 1 + 3 * kGrowth, 1e-9);

  const geometry::MeshFile mesh = result("frame_0003.ply");
  const auto values = [&](const std::string& of) {
    return geometry::scalars(mesh.vertex_attributes, of).value();
  };
  const double width = 12 * 5;
  EXPECT_NEAR(frames[2]["displacement_max"], std::hypot(3 * kGrowth * width, 3 * kFall), 1e-4);
  for (Eigen::Index v = 0; v < sheet.vertices.cols(); ++v) {
    const double x = sheet.vertices(0, v);
    EXPECT_NEAR(values("displacement_x")[v], 3 * kGrowth * x, 1e-4);
    EXPECT_NEAR(values("displacement_z")[v], -3 * kFall, 1e-4);
    // From frame 1 to frame 4, since frame 2 is missing.
    EXPECT_NEAR(values("velocity_x")[v], kGrowth * x * kRate, 1e-3);
    EXPECT_NEAR(values("velocity_z")[v], -kFall * kRate, 1e-3);
    EXPECT_NEAR(values("speed")[v], kRate * std::hypot(kGrowth * x, kFall), 1e-3);
    EXPECT_NEAR(values("stretch_largest")[v], 1 + 3 * kGrowth, 1e-5);
    EXPECT_NEAR(values("stretch_smallest")[v], 1, 1e-5);
    EXPECT_NEAR(std::abs(values("stretch_x")[v]), 1, 1e-5);
    EXPECT_NEAR(values("area_ratio")[v], 1 + 3 * kGrowth, 1e-5);
    EXPECT_EQ(values("sigma_along")[v], 0.5);
  }
}

TEST_F(Motion, ComparesWithTheReferenceThatIsGiven) {
  const CommandResult done = motion({"--reference", scratch / "meshes/frame_0004.ply", "--json"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json frames = json::parse(done.out)["per_frame"];
  EXPECT_NEAR(frames[0]["area_ratio"], 1 / (1 + 4 * kGrowth), 1e-9);
  EXPECT_EQ(frames[3]["displacement_max"], 0);
  EXPECT_FALSE(geometry::scalars(result("frame_0001.ply").vertex_attributes, "speed"));
}

TEST_F(Motion, WritesASeriesForParaView) {
  ASSERT_EQ(motion({"--format", "vtk", "--rate", "50"}).status, kDone);
  const json series = json::parse(read_text(scratch / "motion/motion.vtk.series"));
  ASSERT_EQ(series["files"].size(), 4U);
  EXPECT_EQ(series["files"][3]["name"], "frame_0004.vtk");
  EXPECT_DOUBLE_EQ(series["files"][3]["time"], 0.08);
  EXPECT_THAT(read_text(scratch / "motion/frame_0004.vtk"),
              AllOf(HasSubstr("# vtk DataFile"), HasSubstr("stretch_largest")));
}

TEST_F(Motion, RefusesMeshesOfOtherTriangles) {
  geometry::write_mesh(scratch / "meshes/frame_0005.ply", geometry::test::flat_sheet(3, 3, 5));
  const CommandResult refused = motion();
  EXPECT_EQ(refused.status, kWrongCall);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("frame_0005.ply"), HasSubstr("same triangles")));
  EXPECT_FALSE(fs::exists(scratch / "motion"));
}

TEST_F(Motion, RefusesWhatIsNoSequence) {
  EXPECT_THAT(run_palpate({"motion", scratch / "meshes/frame_0000.ply", "-o", scratch / "m"}).err,
              HasSubstr("give a folder of meshes"));
  EXPECT_THAT(motion({"--rate", "0"}).err, HasSubstr("--rate: is 0; it must be > 0"));
  fs::create_directory(scratch / "empty");
  EXPECT_EQ(run_palpate({"motion", scratch / "empty", "-o", scratch / "m"}).status, kWrongCall);
}

}  // namespace
}  // namespace palpate::apps
