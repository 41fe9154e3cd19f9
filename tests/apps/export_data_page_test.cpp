// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate export --html` of range maps and meshes; tests/web tests the pages themselves.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "export/page_file.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/reason_image.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kRows = 6, kColumns = 8;

class ExportDataPage : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder());
    write_text(folder() / "rig.yaml",
               "%YAML:1.0\n---\ncamera_size: [8, 6]\ncamera_matrix: !!opencv-matrix\n"
               "   { rows: 3, cols: 3, dt: d, data: [9., 0., 3.5, 0., 9., 2.5, 0., 0., 1.] }\n"
               "camera_distortion: []\n");
  }
  [[nodiscard]] fs::path folder() const { return scratch.path() / "range"; }
  [[nodiscard]] fs::path page() const { return scratch.path() / "p.html"; }

  void write_map(const std::string& name, float depth) const {
    geometry::write_depth_tiff(folder() / name, geometry::ImageF::Constant(kRows, kColumns, depth));
  }
  [[nodiscard]] CommandResult export_page(const fs::path& input,
                                          std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"export", input.string(), "--html", "-o", page().string()});
    return run_palpate(more);
  }
  /// Expects that the call fails with these words, and leaves existing files.
  void expect_refused(const fs::path& input, const std::string& words,
                      const std::vector<std::string>& more = {}) const {
    write_text(page(), "earlier");
    const CommandResult result = export_page(input, more);
    EXPECT_NE(result.status, kDone);
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_EQ(read_text(page()), "earlier");
  }
  /// The description of the data for the page's scripts.
  [[nodiscard]] json facts() const {
    const std::string text = read_text(page()), mark = "id=\"facts-data\">";
    const std::size_t begin = text.find(mark) + mark.size();
    return json::parse(text.substr(begin, text.find("</script>", begin) - begin));
  }
  [[nodiscard]] std::vector<std::string> frames() const {
    std::vector<std::string> names;
    const json all = facts();
    for (const json& frame : all["frames"]) names.push_back(frame["name"]);
    return names;
  }

  ScratchFolder scratch;
};

TEST_F(ExportDataPage, IsOneFileThatLoadsNothing) {
  write_map("a<b {{title}}.tiff", 700.3F);
  geometry::write_mesh(scratch / "m.ply", {.vertices = Eigen::Matrix3d::Identity(),
                                           .triangles = Eigen::Vector3i(0, 1, 2)});
  for (const fs::path& input : {folder(), scratch.path() / "m.ply"}) {
    ASSERT_EQ(export_page(input, {"--title", "{{facts}} & <x>"}).status, kDone);
    const std::string text = read_text(page());
    EXPECT_NE(text.find("<title>{{facts}} &amp; &lt;x&gt;</title>"), std::string::npos);
    EXPECT_EQ(text.find("{{blocks"), std::string::npos);
    EXPECT_EQ(text.find("src="), std::string::npos);
    EXPECT_EQ(text.find("http:"), std::string::npos);
    EXPECT_EQ(text.find("https:"), std::string::npos);
    EXPECT_NE(text.find("default-src 'none'"), std::string::npos);
    if (input == folder()) {
      EXPECT_EQ(frames().front(), "a<b {{title}}.tiff");
    }
  }
}

TEST_F(ExportDataPage, RoundsDepthsToATenthOfTheSmallestDeviation) {
  write_map("0.tiff", 700.3F);
  geometry::ImageF sigma = geometry::ImageF::Constant(kRows, kColumns, 0.4F);
  sigma(2, 3) = 0.07F;
  sigma(0, 0) = static_cast<float>(kNaN);
  geometry::write_depth_tiff(folder() / "0_sigma.tiff", sigma);
  const CommandResult result = export_page(folder());
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_EQ(facts()["step"], 0.005);
  EXPECT_NE(result.out.find("1 range map, "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("depths are rounded to 5 um, at most a tenth of any predicted"),
            std::string::npos)
      << result.out;
}

TEST_F(ExportDataPage, KeepsDepthImagesExactly) {
  cv::Mat1w depths(kRows, kColumns, static_cast<std::uint16_t>(5601));
  sensing::write_png(folder() / "0.png", depths);
  const CommandResult result = export_page(folder(), {"--scale", "0.125"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_EQ(facts()["step"], 0.125);
  EXPECT_NE(result.out.find("depths are exact"), std::string::npos) << result.out;
}

TEST_F(ExportDataPage, TakesEachNthFrameOnlyIfItIsAskedTo) {
  for (const char* name : {"8.tiff", "9.tiff", "10.tiff", "11.tiff"}) write_map(name, 500);
  ASSERT_EQ(export_page(folder()).status, kDone);
  EXPECT_EQ(frames(), (std::vector<std::string>{"8.tiff", "9.tiff", "10.tiff", "11.tiff"}));
  ASSERT_EQ(export_page(folder(), {"--every", "3"}).status, kDone);
  EXPECT_EQ(frames(), (std::vector<std::string>{"8.tiff", "11.tiff"}));
  expect_refused(folder() / "8.tiff", "--every: is for a folder", {"--every", "2"});
}

TEST_F(ExportDataPage, IsRefusedIfItWouldBeTooLong) {
  const std::vector<fs::path> files{"a", "b", "c", "d", "e", "f", "g"};
  SequencePage sequence{.kind = "range",
                        .title = "t",
                        .facts = json::object(),
                        .common = {},
                        .files = files,
                        .pack = [](const fs::path&) { return std::vector<std::byte>(100); }};
  const std::size_t whole = write_page(page(), sequence);
  EXPECT_EQ(whole, fs::file_size(page()));
  sequence.most_bytes = whole;
  EXPECT_EQ(write_page(page(), sequence), whole);
  sequence.most_bytes = whole - 1;
  fs::remove(page());
  try {
    (void)write_page(page(), sequence);
    FAIL() << "it was written";
  } catch (const InvalidInput& error) {
    const std::string words = error.what();
    EXPECT_NE(words.find("this and 6 more"), std::string::npos) << words;
    EXPECT_NE(words.find("--every 2"), std::string::npos) << words;
  }
  EXPECT_FALSE(fs::exists(page()));
}

TEST_F(ExportDataPage, SaysWhatItCannotShow) {
  expect_refused(scratch.path() / "missing", "there is no such file or folder");
  fs::create_directory(scratch.path() / "empty");
  expect_refused(scratch.path() / "empty", "is empty; expected a model");
  write_text(scratch / "empty/notes.txt", "x");
  expect_refused(scratch.path() / "empty", "holds nothing that can be exported");
  expect_refused(scratch.path() / "empty/notes.txt", "is not that of a mesh");
  write_map("0.tiff", 500);
  write_text(folder() / "1.tiff", read_text(folder() / "0.tiff").substr(0, 100));
  expect_refused(folder(), "1.tiff");
  const CommandResult kernel =
      run_palpate({"export", (folder() / "0.tiff").string(), "--html", "-o", "/proc/p.html"});
  EXPECT_NE(kernel.status, kDone);
  EXPECT_NE(kernel.err.find("/proc/p.html: cannot be written"), std::string::npos) << kernel.err;
}

TEST_F(ExportDataPage, ShowsMapsWithoutDepthOnlyWithTheirReasons) {
  write_map("0.tiff", static_cast<float>(kNaN));
  expect_refused(folder(), "no pixel of it has a depth");
  sensing::write_reasons(folder() / "0_reasons.tiff",
                         sensing::ReasonImage::Constant(kRows, kColumns, 3));
  ASSERT_EQ(export_page(folder()).status, kDone);
  EXPECT_EQ(facts()["depth"], nullptr);
  EXPECT_EQ(facts()["reasons"][3], "low modulation");
}

TEST_F(ExportDataPage, RefusesCompanionsOfAnotherSize) {
  write_map("0.tiff", 500);
  geometry::write_depth_tiff(folder() / "0_sigma.tiff", geometry::ImageF::Constant(3, 3, 1));
  expect_refused(folder(), "0_sigma.tiff: has 3 x 3 px, but its range map 8 x 6");
}

TEST_F(ExportDataPage, RefusesOptionsOfOtherPages) {
  write_map("0.tiff", 500);
  const std::string mesh = scratch / "m.ply";
  geometry::write_mesh(
      mesh, {.vertices = Eigen::Matrix3d::Identity(), .triangles = Eigen::Vector3i(0, 1, 2)});
  expect_refused(folder(), "--unknown-friction: is for models", {"--unknown-friction", "0.4"});
  expect_refused(folder(), "--unit: is for meshes", {"--unit", "m"});
  expect_refused(folder(), "--scale works for depth images", {"--scale", "1"});
  expect_refused(mesh, "--unknown-friction: is for models", {"--unknown-friction", "0.4"});
  expect_refused(mesh, "--rig: is for range maps", {"--rig", folder() / "rig.yaml"});
  const CommandResult ply = run_palpate({"export", mesh, "--ply", "--every", "2"});
  EXPECT_EQ(ply.status, kWrongCall);
  EXPECT_NE(ply.err.find("--every: is that of a page (--html)"), std::string::npos) << ply.err;
}

TEST_F(ExportDataPage, ShowsMeshesOfTheSameTrianglesAsASequence) {
  const fs::path meshes = scratch.path() / "meshes";
  fs::create_directory(meshes);
  geometry::MeshFile file;
  file.mesh = {.vertices = 100 * Eigen::Matrix3d::Identity(),
               .triangles = Eigen::Vector3i(0, 1, 2)};
  geometry::set_attribute(file.vertex_attributes,
                          {.name = "distance",
                           .values = std::vector<float>{1, static_cast<float>(kNaN), 3},
                           .list_sizes = {}});
  geometry::write_mesh_file(meshes / "0.ply", file);
  file.mesh.vertices.col(0).x() = 170;
  geometry::write_mesh_file(meshes / "1.ply", file);
  ASSERT_EQ(export_page(meshes).status, kDone);
  EXPECT_EQ(frames(), (std::vector<std::string>{"0.ply", "1.ply"}));
  EXPECT_EQ(facts()["size"], (json{170, 100, 100}));
  EXPECT_EQ(facts()["open_edges"], 3);
  EXPECT_EQ(facts()["quantities"][0]["name"], "distance");
  EXPECT_EQ(facts()["quantities"][0]["range"]["max"], 3);
  file.mesh.triangles = Eigen::Vector3i(0, 2, 1);
  geometry::write_mesh_file(meshes / "2.ply", file);
  expect_refused(meshes, "2.ply: has 3 vertices and 1 triangles, not the same as");
}

}  // namespace
}  // namespace palpate::apps
