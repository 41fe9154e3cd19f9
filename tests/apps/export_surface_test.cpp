// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate export` of surfaces for other programs.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <string>

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
