// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate mesh` carries colours and deviations of vertices through its steps, and remeshes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "cgal_availability.h"
#include "mesh_corpus.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/self_intersections.h"
#include "palpate/geometry/texture.h"
#include "run_palpate.h"
#include "test_surfaces.h"

namespace palpate::apps {
namespace {

using ::testing::HasSubstr;

/// Colour and deviation of a place: they change evenly over the surface.
double red_at(const Eigen::Vector3d& place) { return 3 * place.x() + 20; }
double sigma_at(const Eigen::Vector3d& place) { return 0.1 + 0.01 * place.y(); }

class MeshAttributes : public ::testing::Test {
 protected:
  void SetUp() override {
    geometry::MeshFile file;
    file.mesh = geometry::test::height_field(
        40, 30, 1.5, [](double x, double y) { return 4 * std::sin(x / 12) * std::cos(y / 9); });
    std::vector<std::uint8_t> red, green;
    std::vector<float> sigma, normal;
    for (const auto& v : file.mesh.vertices.colwise()) {
      red.push_back(static_cast<std::uint8_t>(std::round(red_at(v))));
      green.push_back(77);
      sigma.push_back(static_cast<float>(sigma_at(v)));
      normal.push_back(1);
    }
    file.vertex_attributes = {{"nx", normal, {}},  {"ny", normal, {}},   {"nz", normal, {}},
                              {"red", red, {}},    {"green", green, {}}, {"blue", green, {}},
                              {"sigma", sigma, {}}};
    geometry::write_mesh_file(scratch / "scan.ply", file);
  }

  /// The mesh after steps, with its attributes compared with those of the places of its vertices.
  geometry::MeshFile after(std::vector<std::string> steps, double color_error) {
    steps.insert(steps.begin(), {"mesh", scratch / "scan.ply", "-o", scratch / "out.ply"});
    const CommandResult result = run_palpate(steps);
    EXPECT_EQ(result.status, kDone) << result.err;
    geometry::MeshFile file = geometry::read_mesh_file(scratch / "out.ply");
    EXPECT_EQ(geometry::find_attribute(file.vertex_attributes, "nx"), nullptr);
    const auto colors = geometry::colors(file.vertex_attributes);
    const auto sigma = geometry::scalars(file.vertex_attributes, "sigma");
    EXPECT_TRUE(colors && sigma);
    if (!colors || !sigma) return file;
    for (Eigen::Index v = 0; v < file.mesh.vertices.cols(); ++v) {
      const Eigen::Vector3d at = file.mesh.vertices.col(v);
      EXPECT_NEAR(255 * (*colors)(0, v), red_at(at), color_error);
      EXPECT_NEAR(255 * (*colors)(1, v), 77, 1e-9);
      EXPECT_NEAR((*sigma)[v], sigma_at(at), 1e-6 + 0.01 * color_error / 3);
    }
    return file;
  }

  ScratchFolder scratch;
};

/// Colours are rounded when they are made.
constexpr double kRounded = 0.5 + 1e-9;

TEST_F(MeshAttributes, AreThoseOfTheVerticesThatDecimationKeeps) {
  const geometry::MeshFile file = after({"--tolerance", "0.2"}, kRounded);
  EXPECT_LT(file.mesh.triangles.cols(), 1000);
}

TEST_F(MeshAttributes, AreInterpolatedWhereRemeshingPutsVertices) {
  // Rounded once more, and linear in each triangle.
  const geometry::MeshFile file = after({"--remesh", "3"}, 2 * kRounded);
  EXPECT_NEAR(geometry::mesh_shape(file.mesh).mean_edge, 3, 0.4);
}

TEST_F(MeshAttributes, GoThroughAllStepsTogether) {
  (void)after({"--repair", "--fill-holes", "5", "--remesh", "1", "--tolerance", "0.1"},
              2 * kRounded);
}

TEST_F(MeshAttributes, RemeshingReportsFiguresAndRefusesWhatIsTooFine) {
  const CommandResult result = run_palpate(
      {"mesh", scratch / "scan.ply", "--remesh", "2", "-o", scratch / "even.ply", "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const auto figures = nlohmann::json::parse(result.out)["remeshing"];
  EXPECT_EQ(figures["triangles_before"], 2400);
  EXPECT_NEAR(figures["mean_edge"].get<double>(), 2, 0.3);
  const CommandResult fine =
      run_palpate({"mesh", scratch / "scan.ply", "--remesh", "1e-4", "-o", scratch / "fine.ply"});
  EXPECT_EQ(fine.status, kWrongCall);
  EXPECT_THAT(fine.err, HasSubstr("at least"));
  const CommandResult alone = run_palpate(
      {"mesh", scratch / "scan.ply", "--feature-angle", "30", "-o", scratch / "fine.ply"});
  EXPECT_EQ(alone.status, kWrongCall);
  EXPECT_THAT(alone.err, HasSubstr("--remesh"));
}

TEST_F(MeshAttributes, VerticesOfASpikeThatIsRemovedTakeThemFromTheSurfaceAround) {
  if (!geometry::test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
  geometry::MeshFile file = geometry::read_mesh_file(scratch / "scan.ply");
  const geometry::TriangleMesh sheet = file.mesh;
  const int spike = 15 * 41 + 20;  // near the middle
  file.mesh.vertices.col(spike) += Eigen::Vector3d(7, 3, 2);
  file.mesh.vertices.col(spike + 3) += Eigen::Vector3d(0, 0, 3);  // through the first one's side
  geometry::write_mesh_file(scratch / "scan.ply", file);
  const CommandResult result = run_palpate({"mesh", scratch / "scan.ply", "--remove-intersections",
                                            "-o", scratch / "out.ply", "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const auto figures = nlohmann::json::parse(result.out)["self_intersections"];
  EXPECT_GT(figures["found"], 1);
  EXPECT_EQ(figures["left"], 0);
  file = geometry::read_mesh_file(scratch / "out.ply");
  EXPECT_TRUE(geometry::intersecting_triangles(file.mesh).empty());
  const auto colors = geometry::colors(file.vertex_attributes);
  ASSERT_TRUE(colors);
  const double reach = 12;  // [mm] of the spike and the triangles around it
  for (Eigen::Index v = 0; v < file.mesh.vertices.cols(); ++v) {
    const Eigen::Vector3d at = file.mesh.vertices.col(v);
    const bool is_near = (at - sheet.vertices.col(spike)).norm() < reach;
    EXPECT_NEAR(255 * (*colors)(0, v), red_at(at), is_near ? 3 * reach : kRounded);
  }
}

/// A sheet whose picture is cut in the middle: the halves are at two places of two pictures.
geometry::MeshFile cut_sheet() {
  geometry::MeshFile file;
  file.mesh = geometry::test::height_field(
      40, 30, 1.5, [](double x, double y) { return 4 * std::sin(x / 12) * std::cos(y / 9); });
  geometry::CornerTexture texture;
  texture.coordinates.resize(6, file.mesh.triangles.cols());
  texture.number.resize(file.mesh.triangles.cols());
  for (Eigen::Index t = 0; t < file.mesh.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = file.mesh.vertices(Eigen::all, file.mesh.triangles.col(t));
    const bool right = corners.row(0).mean() > 30;
    texture.number[t] = right ? 1 : 0;
    for (int k = 0; k < 3; ++k)
      texture.coordinates.block<2, 1>(2 * k, t) =
          0.01 * (corners.col(k).head<2>() + Eigen::Vector2d(right ? 500 : 0, 0));
  }
  geometry::set_corner_texture(file.triangle_attributes, texture);
  file.materials = {"left", "right"};
  file.material_files = {"scan.mtl"};
  return file;
}

TEST_F(MeshAttributes, TheTextureOfAnObjGoesThroughAllStepsButRemeshing) {
  std::filesystem::create_directory(scratch / "made");
  const geometry::MeshFile sheet = cut_sheet();
  geometry::write_mesh_file(scratch / "scan.obj", sheet);
  const CommandResult result =
      run_palpate({"mesh", scratch / "scan.obj", "--repair", "--fill-holes", "1", "--tolerance",
                   "0.2", "-o", scratch / "made/out.obj"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const geometry::MeshFile file = geometry::read_mesh_file(scratch / "made/out.obj");
  EXPECT_EQ(file.materials, sheet.materials);
  EXPECT_EQ(file.material_files, std::vector<std::string>{"../scan.mtl"});
  EXPECT_LT(file.mesh.triangles.cols(), sheet.mesh.triangles.cols() / 2);
  EXPECT_EQ(geometry::boundary_loops(file.mesh).size(), 1U);  // no crack at the cut
  const auto texture = geometry::corner_texture(file.triangle_attributes);
  ASSERT_TRUE(texture);
  for (Eigen::Index t = 0; t < file.mesh.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = file.mesh.vertices(Eigen::all, file.mesh.triangles.col(t));
    const bool right = texture->number[t] == 1;
    EXPECT_GT(right ? corners.row(0).mean() : 60 - corners.row(0).mean(), 30 - 0.2);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d expected =
          0.01 * (corners.col(k).head<2>() + Eigen::Vector2d(right ? 500 : 0, 0));
      EXPECT_LT((texture->coordinates.block<2, 1>(2 * k, t) - expected).norm(), 1e-9);
    }
  }
  const CommandResult even =
      run_palpate({"mesh", scratch / "scan.obj", "--remesh", "2", "-o", scratch / "even.obj"});
  EXPECT_EQ(even.status, kDone);
  EXPECT_THAT(even.err, HasSubstr("the texture is left out"));
  EXPECT_TRUE(geometry::read_mesh_file(scratch / "even.obj").triangle_attributes.empty());
  const CommandResult exported =
      run_palpate({"export", scratch / "scan.obj", "--obj", "-o", scratch / "made/exported.obj"});
  ASSERT_EQ(exported.status, kDone) << exported.err;
  EXPECT_EQ(geometry::read_mesh_file(scratch / "made/exported.obj").material_files,
            std::vector<std::string>{"../scan.mtl"});
  const CommandResult ply = run_palpate({"mesh", scratch / "scan.obj", "-o", scratch / "out.ply"});
  EXPECT_THAT(ply.err, HasSubstr("PLY has no materials, so those of scan.mtl"));
  EXPECT_EQ(
      geometry::corner_texture(geometry::read_mesh_file(scratch / "out.ply").triangle_attributes)
          ->coordinates,
      geometry::corner_texture(sheet.triangle_attributes)->coordinates);
}

TEST_F(MeshAttributes, ASurfaceThatWouldTearKeepsMoreTrianglesThanAskedForAndSaysSo) {
  write_text(scratch / "tetrahedron.off",
             "OFF\n4 4 0\n0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  const CommandResult result = run_palpate(
      {"mesh", scratch / "tetrahedron.off", "--max-triangles", "2", "-o", scratch / "out.ply"});
  EXPECT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err, HasSubstr("4 triangles are left, not 2 (--max-triangles)"));
}

}  // namespace
}  // namespace palpate::apps
