// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate motion`: values of surfaces whose motion is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
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
  /// Gives the meshes of frames 0, 1, 3 and 4 other names.
  void rename_to(const std::vector<std::string>& names) const {
    constexpr const char* kFrames = "0134";
    for (std::size_t i = 0; i < names.size(); ++i) {
      fs::rename(scratch / ("meshes/frame_000" + std::string(1, kFrames[i]) + ".ply"),
                 scratch / ("meshes/" + names[i] + ".ply"));
    }
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

// As `track` names the meshes of a recording in the layout of TUM RGB-D.
TEST_F(Motion, TakesNamesThatAreTimesForSeconds) {
  rename_to({"1305031102.95", "1305031102.97", "1305031103.01", "1305031103.03"});
  const CommandResult done = motion({"--json"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json frames = json::parse(done.out)["per_frame"];
  constexpr double kRounding = 1e-6;  // [s] of double precision
  EXPECT_NEAR(frames[3]["time"], 4 / kRate, kRounding);
  const Eigen::VectorXd fall =
      geometry::scalars(result("1305031103.01.ply").vertex_attributes, "velocity_z").value();
  EXPECT_NEAR(fall.maxCoeff(), -kFall * kRate, 0.01);
  EXPECT_NEAR(fall.minCoeff(), -kFall * kRate, 0.01);
  const CommandResult refused = motion({"--rate", "50"});
  EXPECT_EQ(refused.status, kWrongCall);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("1305031102.95.ply"), HasSubstr("leave out --rate")));
}

TEST_F(Motion, SortsTimesByTheirValue) {
  rename_to({"9.75", "9.8", "10", "10.25"});  // not all are times: by their names
  EXPECT_EQ(json::parse(motion({"--json"}).out)["per_frame"][3]["time"], 3);
  fs::rename(scratch / "meshes/10.ply", scratch / "meshes/9.900.ply");
  fs::remove_all(scratch / "motion");
  const json frames = json::parse(motion({"--json"}).out)["per_frame"];
  EXPECT_THAT(frames[2]["file"].get<std::string>(), HasSubstr("9.900.ply"));
  EXPECT_DOUBLE_EQ(frames[3]["time"], 0.5);
}

TEST_F(Motion, CountsTheFramesIfTheirNamesEndInDecimalsOrInLongNumbers) {
  for (const std::vector<std::string>& names : std::vector<std::vector<std::string>>{
           {"d_5.003", "d_5.036", "d_5.103", "d_5.136"},
           {"d_1305031102160", "d_1305031102193", "d_1305031102260", "d_1305031102293"}}) {
    const ScratchFolder other;
    fs::create_directory(other / "meshes");
    std::size_t i = 0;
    for (const char frame : {'0', '1', '3', '4'}) {
      fs::copy(scratch / ("meshes/frame_000" + std::string(1, frame) + ".ply"),
               other / ("meshes/" + names[i++] + ".ply"));
    }
    const CommandResult done =
        run_palpate({"motion", other / "meshes", "-o", other / "motion", "--json"});
    ASSERT_EQ(done.status, kDone) << done.err;
    EXPECT_EQ(json::parse(done.out)["per_frame"][3]["time"], 3);
  }
}

// A sheet that falls freely; the tracked vertices scatter by 0.3 mm, and frame 6 was lost.
TEST_F(Motion, SmoothsPositionsOverTimeAndSaysHowWell) {
  constexpr double kNoise = 0.3, kAcceleration = 2000;  // [mm], [mm/s^2]
  fs::remove_all(scratch / "meshes");
  fs::create_directory(scratch / "meshes");
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, kNoise);
  const auto height = [&](int frame) {
    return -kAcceleration / 2 * frame * frame / (kRate * kRate);
  };
  for (int frame = 0; frame < 13; ++frame) {
    if (frame == 6) continue;
    geometry::TriangleMesh mesh = sheet;
    mesh.vertices.row(2).array() += height(frame);
    for (double& number : mesh.vertices.reshaped()) number += noise(random);
    geometry::write_mesh(scratch / ("meshes/" + std::to_string(100 + frame) + ".ply"), mesh);
  }
  const CommandResult done =
      motion({"--rate", std::to_string(kRate), "--window", "0.13", "--json"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json frames = json::parse(done.out)["per_frame"];
  ASSERT_EQ(frames.size(), 12U);
  EXPECT_EQ(frames[0]["displacement_max"], 0);
  const geometry::MeshFile mesh = result("105.ply");
  geometry::TriangleMesh truth = sheet;
  truth.vertices.row(2).array() += height(5);
  const double error = std::sqrt((mesh.mesh.vertices - truth.vertices).squaredNorm() /
                                 static_cast<double>(truth.vertices.size()));
  EXPECT_LT(error, 0.6 * kNoise);
  EXPECT_GT(frames[5]["sigma_smoothed"].get<double>() / error, 0.8);
  EXPECT_LT(frames[5]["sigma_smoothed"].get<double>() / error, 1.2);
  const auto fall = geometry::scalars(mesh.vertex_attributes, "velocity_z").value();
  double mean = 0;
  for (const double value : fall) mean += value / static_cast<double>(fall.size());
  EXPECT_NEAR(mean, -kAcceleration * 5 / kRate, 2);
}

TEST_F(Motion, SmoothsOnlyWhereTheWindowHasEnoughFrames) {
  const CommandResult some = motion({"--window", "3.5", "--json"});
  EXPECT_EQ(some.status, kDone);
  EXPECT_THAT(some.err,
              HasSubstr("2 of 4 frames are not smoothed: their windows have fewer than 4 frames"));
  fs::remove_all(scratch / "motion");
  const CommandResult none = motion({"--window", "2.5"});
  EXPECT_EQ(none.status, kWrongCall);
  EXPECT_THAT(none.err, HasSubstr("--window: 2.5 frames is too short: no window has the 4 frames"));
  EXPECT_FALSE(fs::exists(scratch / "motion"));
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
