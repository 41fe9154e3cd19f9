// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate fit --shapes`: the response of the whole surface of a model to the tool.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// A flat square with four contacts, pressed to two depths with a range map each, and the meshes of
/// these, in which the surface follows by exp(-(d / 15 mm)^2).
class FitShapes : public ::testing::Test {
 protected:
  void SetUp() override { write(4); }

  void write(int cell) const {  // [mm]
    const int side = 80 / cell + 1;
    geometry::TriangleMesh sheet;
    sheet.vertices.resize(3, side * side);
    for (int i = 0; i < side * side; ++i)
      sheet.vertices.col(i) << cell * (i % side) - 40, cell * (i / side) - 40, 700;
    sheet.triangles.resize(3, 2 * (side - 1) * (side - 1));
    for (int y = 0, t = 0; y + 1 < side; ++y) {
      for (int x = 0; x + 1 < side; ++x) {
        const int corner = y * side + x;
        sheet.triangles.col(t++) << corner, corner + side, corner + 1;
        sheet.triangles.col(t++) << corner + 1, corner + side, corner + side + 1;
      }
    }
    geometry::write_mesh(scratch.path() / "sheet.ply", sheet);
    std::filesystem::create_directories(scratch.path() / "meshes");
    probing::Acquisition acquisition;
    for (long long c = 0; c < 4; ++c) {
      const Eigen::Vector3d place(c % 2 == 0 ? -20 : 20, c < 2 ? -20 : 20, 700);
      acquisition.contacts.push_back({c, place, {0, 0, -1}});
      for (long long k = 1; k <= 2; ++k) {
        probing::Sample sample;
        sample.id = sample.group = 2 * c + k;
        sample.contact = c;
        sample.force << 0, 0, static_cast<double>(k);
        sample.a = sample.b = place + 3 * sample.force;
        const std::string name = "00000" + std::to_string(sample.id);
        sample.range_map = "range/" + name + ".tiff";
        acquisition.samples.push_back(sample);
        geometry::TriangleMesh moved = sheet;
        for (Eigen::Index v = 0; v < moved.vertices.cols(); ++v) {
          const double d = (sheet.vertices.col(v) - place).norm() / 15;
          moved.vertices.col(v) += std::exp(-d * d) * (sample.b - place);
        }
        geometry::write_mesh(scratch.path() / "meshes" / (name + ".ply"), moved);
      }
    }
    probing::write_acquisition(scratch.path() / "a.db", acquisition);
  }

  CommandResult fit() const {
    return run_palpate({"--json", "fit", scratch / "a.db", scratch / "sheet.ply", "--shapes",
                        scratch / "meshes", "-o", scratch / "model"});
  }

  ScratchFolder scratch;
};

TEST_F(FitShapes, WritesHowTheSurfaceFollowsTheTool) {
  const CommandResult result = fit();
  ASSERT_EQ(result.status, 0) << result.err;
  const json shapes = json::parse(result.out).at("shapes");
  EXPECT_EQ(shapes.at("count"), 8);
  EXPECT_LT(shapes.at("rms"), 0.05);
  EXPECT_LT(shapes.at("largest"), 1);
  const haptics::Model model = haptics::read_model(scratch.path() / "model");
  ASSERT_TRUE(model.response);
  EXPECT_EQ(model.response->shape_contacts.size(), 8);
  EXPECT_EQ(model.response->rms, shapes.at("rms"));
  EXPECT_THAT(run_palpate({"info", scratch / "model"}).out, HasSubstr("8 recorded shapes"));
}

TEST_F(FitShapes, TakesMeshesOfASurfaceWhoseTrianglesAreTooLargeForTheWeights) {
  std::filesystem::remove(scratch.path() / "a.db");
  write(20);
  const CommandResult result = fit();
  ASSERT_EQ(result.status, 0) << result.err;
  const json figures = json::parse(result.out);
  const haptics::Model model = haptics::read_model(scratch.path() / "model");
  EXPECT_GT(model.surface.vertices.cols(), 25);
  EXPECT_EQ(figures.at("surface_vertices"), model.surface.vertices.cols());
  EXPECT_EQ(figures.at("added_vertices"), model.surface.vertices.cols() - 25);
  ASSERT_TRUE(model.response);
  EXPECT_LT(model.response->kept_rms, 0.05);
}

TEST_F(FitShapes, SaysWhatIsWrongWithTheMeshes) {
  std::ofstream(scratch.path() / "meshes/000003.ply") << "ply\nformat ascii";
  CommandResult result = fit();
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("000003.ply"));
  geometry::TriangleMesh other = geometry::read_mesh(scratch.path() / "sheet.ply");
  other.triangles.col(7).reverseInPlace();
  geometry::write_mesh(scratch.path() / "meshes/000003.ply", other);
  result = fit();
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("000003.ply: has other triangles"));
  EXPECT_THAT(result.err, HasSubstr("--reference SURFACE"));
  std::filesystem::remove_all(scratch.path() / "meshes");
  result = fit();
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("8 samples name a range map, and none has a mesh"));
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "model"));
}

}  // namespace
}  // namespace palpate::apps
