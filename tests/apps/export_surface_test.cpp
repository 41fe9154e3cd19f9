// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate export` of surfaces for other programs.
#include <gtest/gtest.h>

#include <string>

#include "../haptics/sheet_model.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/model_io.h"
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
