// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate export` of surfaces for other programs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "../haptics/sheet_model.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/model_io.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/rig.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

TEST(ExportSurface, WritesModelsMeshesAndRangeMapsInAllFormats) {
  const ScratchFolder scratch;
  const haptics::Model model = haptics::sheet_model();
  haptics::write_model(scratch / "m", model);
  geometry::write_mesh(scratch / "m.stl", model.surface);
  const std::string map = demo("truth/duck.tiff");
  for (const std::string& input : {scratch / "m", scratch / "m.stl", map}) {
    for (const std::string& ending : std::vector<std::string>{"ply", "obj", "vtk", "glb"}) {
      const std::string output = scratch / ("out." + ending);
      fs::remove(output);
      std::vector<std::string> words = {"export", input, "--" + ending, "-o", output};
      if (input == map) words.insert(words.end(), {"--rig", demo("rig.yaml")});
      const CommandResult result = run_palpate(words);
      ASSERT_EQ(result.status, kDone) << result.err;
      if (ending == "vtk") continue;  // nothing here reads it
      const geometry::TriangleMesh read = geometry::read_mesh(output);
      if (input == map) {
        EXPECT_GT(read.triangles.cols(), 10'000);
      } else {
        EXPECT_EQ(read.triangles.cols(), model.surface.triangles.cols());
        EXPECT_NEAR(read.vertices.row(2).mean(), 700, 1e-3);
      }
    }
  }
}

TEST(ExportSurface, GivesTheColourOfARangeMapAndKeepsThatOfAMesh) {
  const ScratchFolder scratch;
  fs::copy_file(demo("truth/duck.tiff"), scratch / "duck.tiff");
  const std::vector<std::string> call = {
      "export", scratch / "duck.tiff", "--color", "--ply",
      "--rig",  demo("rig.yaml"),      "-o",      scratch / "duck.ply"};
  const CommandResult missing = run_palpate(call);
  EXPECT_EQ(missing.status, kWrongCall);
  EXPECT_NE(missing.err.find("duck_color.png: missing. --color needs"), std::string::npos);
  // Left half red, right half blue; the camera looks along z, so the column determines the half.
  const sensing::Rig rig = sensing::read_rig(demo("rig.yaml"));
  cv::Mat picture(rig.camera.height, rig.camera.width, CV_8UC3, cv::Scalar(0, 0, 255));
  picture.colRange(picture.cols / 2, picture.cols) = cv::Scalar(255, 0, 0);
  sensing::write_png(scratch / "duck_color.png", picture);
  const CommandResult done = run_palpate(call);
  ASSERT_EQ(done.status, kDone) << done.err;
  const CommandResult again =
      run_palpate({"export", scratch / "duck.ply", "--ply", "-o", scratch / "again.ply"});
  ASSERT_EQ(again.status, kDone) << again.err;
  for (const char* name : {"duck.ply", "again.ply"}) {
    const geometry::MeshFile file = geometry::read_mesh_file(scratch / name);
    const auto rgb = geometry::colors(file.vertex_attributes);
    ASSERT_TRUE(rgb);
    Eigen::Index wrong = 0;
    for (Eigen::Index i = 0; i < file.mesh.vertices.cols(); ++i) {
      const Eigen::Vector3d p = file.mesh.vertices.col(i);
      const double u = rig.camera.fx * p.x() / p.z() + rig.camera.cx;
      const double border = picture.cols / 2 - 0.5;
      if (std::abs(u - border) < 1) continue;  // either of the pixels beside it
      const Eigen::Vector3d expected =
          u < border ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
      wrong += (rgb->col(i).head<3>() - expected).norm() < 1e-6 ? 0 : 1;
    }
    EXPECT_EQ(wrong, 0) << name;
  }
}

TEST(ExportSurface, WritesSeveralFormatsUnderOneName) {
  const ScratchFolder scratch;
  const haptics::Model model = haptics::sheet_model();
  haptics::write_model(scratch / "m", model);
  const CommandResult done = run_palpate(
      {"export", scratch / "m", "--obj", "--json", "--ply", "--html", "-o", scratch / "v1.2"});
  ASSERT_EQ(done.status, kDone) << done.err;
  for (const std::string ending : {".obj", ".ply"})
    EXPECT_EQ(geometry::read_mesh(scratch / ("v1.2" + ending)).triangles, model.surface.triangles);
  ASSERT_EQ(run_palpate({"export", scratch / "m", "--json", "-o", scratch / "one.json"}).status,
            kDone);
  EXPECT_EQ(read_text(scratch / "v1.2.json"), read_text(scratch / "one.json"));
  EXPECT_NE(read_text(scratch / "v1.2.html").find("<html"), std::string::npos);
  for (const char* ending : {"obj", "ply", "json", "html"})
    EXPECT_NE(done.out.find("Written to " + scratch / (std::string("v1.2.") + ending)),
              std::string::npos)
        << done.out;
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"export", scratch / "m"});
    const CommandResult refused = run_palpate(options);
    EXPECT_EQ(refused.status, kWrongCall);
    return refused.err;
  };
  EXPECT_NE(refusal({"--obj", "--ply", "-o", scratch / "n.obj"}).find("choose one without"),
            std::string::npos);
  EXPECT_NE(refusal({"--obj", "--material", "sofa", "-o", scratch / "n"})
                .find("--material: writes a solid"),
            std::string::npos);
  EXPECT_NE(refusal({"-o", scratch / "n"}).find("--ply"), std::string::npos);
  geometry::write_mesh(scratch / "s.ply", model.surface);
  const CommandResult mesh =
      run_palpate({"export", scratch / "s.ply", "--obj", "--json", "-o", scratch / "n"});
  EXPECT_NE(mesh.err.find("is not a model"), std::string::npos);
  EXPECT_FALSE(fs::exists(scratch / "n.obj"));  // nothing, rather than a part
}

TEST(ExportSurface, GivesTheSurfaceOfAModelTheForcesOfPresses) {
  const ScratchFolder scratch;
  haptics::write_model(scratch / "m", haptics::sheet_model());
  const CommandResult without =
      run_palpate({"export", scratch / "m", "--ply", "-o", scratch / "m.ply"});
  ASSERT_EQ(without.status, kDone) << without.err;
  EXPECT_NE(without.out.find("without forces: the model does not tell"), std::string::npos);
  EXPECT_TRUE(geometry::read_mesh_file(scratch / "m.ply").vertex_attributes.empty());
  const CommandResult pressed = run_palpate(
      {"export", scratch / "m", "--ply", "--vtk", "--press-depth", "3", "-o", scratch / "pressed"});
  ASSERT_EQ(pressed.status, kDone) << pressed.err;
  EXPECT_NE(pressed.out.find("force [N] are those of presses 3 mm deep"), std::string::npos);
  // f = 4 d / sqrt(d^2 + 100) along the displacement.
  const geometry::MeshFile file = geometry::read_mesh_file(scratch / "pressed.ply");
  const auto force = geometry::scalars(file.vertex_attributes, "scalar_force");
  const auto stiffness = geometry::scalars(file.vertex_attributes, "scalar_stiffness");
  const auto quality = geometry::scalars(file.vertex_attributes, "quality");
  ASSERT_TRUE(force && stiffness && quality);
  Eigen::Index known = 0;
  for (Eigen::Index i = 0; i < force->size(); ++i) {
    if (std::isnan((*force)[i])) continue;
    ++known;
    EXPECT_NEAR((*force)[i], 12 / std::sqrt(109), 1e-6);
    EXPECT_NEAR((*stiffness)[i], 400 / std::pow(109, 1.5), 1e-6);
    EXPECT_EQ((*quality)[i], (*stiffness)[i]);
  }
  EXPECT_GT(known, force->size() / 4);
  const std::string vtk = read_text(scratch / "pressed.vtk");
  EXPECT_NE(vtk.find("\nstiffness 1 121 float\n"), std::string::npos);
  EXPECT_NE(vtk.find("\nforce 1 121 float\n"), std::string::npos);
  const CommandResult obj = run_palpate(
      {"export", scratch / "m", "--obj", "--press-depth", "3", "-o", scratch / "m.obj"});
  EXPECT_EQ(obj.status, kWrongCall);
  EXPECT_NE(obj.err.find("--press-depth: is for the surface of a model"), std::string::npos);
}

TEST(ExportSurface, NamesTheValuesOfAMeshAsViewersOfPlyReadThem) {
  const ScratchFolder scratch;
  geometry::MeshFile file;
  file.mesh = haptics::sheet_model().surface;
  const auto count = static_cast<std::size_t>(file.mesh.vertices.cols());
  file.vertex_attributes = {{"sigma", std::vector<double>(count, 0.25), {}}};
  geometry::write_mesh_file(scratch / "fused.ply", file);
  const CommandResult done =
      run_palpate({"export", scratch / "fused.ply", "--ply", "--vtk", "-o", scratch / "shown"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const std::string header = read_text(scratch / "shown.ply");
  EXPECT_NE(header.find("property double scalar_sigma\nproperty float quality\n"),
            std::string::npos);
  EXPECT_NE(read_text(scratch / "shown.vtk").find("\nsigma 1 121 double\n"), std::string::npos);
}

TEST(ExportSurface, NamesTheValuesOfPointsToo) {
  const ScratchFolder scratch;
  geometry::PointCloud cloud;
  cloud.points = Eigen::Matrix3Xd::Random(3, 5);
  cloud.width = 5;
  cloud.attributes = {{"cluster", std::vector<std::int32_t>{0, 1, 1, -1, 2}, {}}};
  geometry::write_point_cloud(scratch / "points.pcd", cloud);
  const CommandResult done =
      run_palpate({"export", scratch / "points.pcd", "--ply", "-o", scratch / "shown.ply"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const geometry::PointCloud read = geometry::read_point_cloud(scratch / "shown.ply");
  EXPECT_EQ(read.points, cloud.points);
  ASSERT_EQ(read.attributes.size(), 2U);
  EXPECT_EQ(read.attributes[0].name, "scalar_cluster");
  EXPECT_EQ(read.attributes[0].values, cloud.attributes[0].values);
  EXPECT_EQ(read.attributes[1].name, "quality");
  const CommandResult obj =
      run_palpate({"export", scratch / "points.pcd", "--ply", "--obj", "-o", scratch / "none"});
  EXPECT_EQ(obj.status, kWrongCall);
  EXPECT_NE(obj.err.find("has points without a surface"), std::string::npos);
  EXPECT_FALSE(fs::exists(scratch / "none.ply"));
}

TEST(ExportSurface, SaysWhatCannotBeExported) {
  const ScratchFolder scratch;
  fs::create_directory(scratch.path() / "meshes");
  geometry::write_mesh(scratch / "meshes/0.ply", haptics::sheet_model().surface);
  const auto refused = [&](const std::string& input, const std::string& format,
                           const std::string& output, const std::string& why) {
    const CommandResult result =
        run_palpate({"export", scratch / input, format, "-o", scratch / output});
    EXPECT_NE(result.status, kDone);
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(scratch / output));
  };
  refused("meshes/0.ply", "--glb", "out", "must end in .glb");
  refused("meshes", "--obj", "out.obj", "is a folder of several");
  refused("meshes/0.ply", "--json", "out.json", "is not a model");
  refused("none.ply", "--obj", "out.obj", "none.ply");
}

}  // namespace
}  // namespace palpate::apps
