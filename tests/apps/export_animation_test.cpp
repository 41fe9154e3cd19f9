// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate export --glb` of a folder: a surface whose motion is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "run_palpate.h"
#include "test_surfaces.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kSink = 3.1;  // [mm] in a frame

class ExportAnimation : public ::testing::Test {
 protected:
  // A sheet that sinks. Frame 2 was lost.
  ExportAnimation() {
    fs::create_directory(scratch / "tracked");
    std::string record = R"({"kind":"frames of palpate track","settings":{},"inputs":[]})"
                         "\n";
    for (int frame = 0; frame < 5; ++frame) {
      const std::string name = "frame_000" + std::to_string(frame);
      json item = {{"range_map", name + ".tiff"}, {"fingerprint", ""}};
      if (frame == 2) {
        item["lost"] = "too far away";
      } else {
        geometry::TriangleMesh moved = sheet;
        moved.vertices.row(2).array() -= kSink * frame;
        geometry::write_mesh(scratch / ("tracked/" + name + ".ply"), moved);
      }
      record += item.dump() + "\n";
    }
    write_text(scratch / "tracked/track.jsonl", record);
  }

  CommandResult animate(const std::vector<std::string>& options = {}) {
    std::vector<std::string> words = {"export", scratch / "tracked", "--glb", "-o",
                                      scratch / "motion.glb"};
    words.insert(words.end(), options.begin(), options.end());
    return run_palpate(words);
  }

  /// The JSON of the file that was written.
  json document() {
    const std::string bytes = read_text(scratch / "motion.glb");
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, sizeof(size));
    return json::parse(bytes.substr(20, size));
  }
  static json accessor(const json& document, const json& index) {
    return document["accessors"].at(index.get<std::size_t>());
  }
  static float end_of(const json& document) {
    const json& input = document["animations"][0]["samplers"][0]["input"];
    return accessor(document, input)["max"][0].get<float>();
  }
  /// [m] Distance by which the sheet has sunk at each target.
  static std::vector<float> sunk(const json& document) {
    std::vector<float> depths;
    for (const json& target : document["meshes"][0]["primitives"][0]["targets"])
      depths.push_back(-accessor(document, target["POSITION"])["min"][2].get<float>());
    return depths;
  }

  ScratchFolder scratch;
  geometry::TriangleMesh sheet = geometry::test::flat_sheet(12, 8, 5);
};

TEST_F(ExportAnimation, PlaysTheTrackedFramesAtTheirTimes) {
  const CommandResult done = animate({"--rate", "50"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json motion = document();
  EXPECT_FLOAT_EQ(end_of(motion), 4 / 50.0F);
  const std::vector<float> depths = sunk(motion);
  ASSERT_EQ(depths.size(), 3U);
  EXPECT_NEAR(depths[0], 1e-3 * kSink, 1e-9);
  EXPECT_NEAR(depths[1], 3e-3 * kSink, 1e-9);
  EXPECT_NEAR(depths[2], 4e-3 * kSink, 1e-9);
  const geometry::TriangleMesh first = geometry::read_mesh(scratch / "motion.glb");
  EXPECT_EQ(first.triangles, sheet.triangles);
  EXPECT_LT((first.vertices - sheet.vertices).cwiseAbs().maxCoeff(), 1e-4);
}

TEST_F(ExportAnimation, SaysWhatItWroteAndWhichFramesWereLost) {
  EXPECT_THAT(animate({"--rate", "50"}).out,
              AllOf(HasSubstr("4 frames of 117 vertices in 0.08 s"), Not(HasSubstr("--rate")),
                    HasSubstr("1 frame of the sequence was lost and left out (frame_0002.tiff)")));
  EXPECT_THAT(animate().out, HasSubstr("in 0.8 s (5 frames per second; --rate sets another rate)"));
  fs::remove(scratch / "tracked/track.jsonl");
  EXPECT_THAT(animate().out, Not(HasSubstr("lost")));
}

TEST_F(ExportAnimation, TakesEveryNthFrameAtItsTime) {
  ASSERT_EQ(animate({"--rate", "50", "--every", "2"}).status, kDone);
  const json motion = document();
  EXPECT_FLOAT_EQ(end_of(motion), 3 / 50.0F);
  EXPECT_EQ(sunk(motion).size(), 1U);
}

TEST_F(ExportAnimation, TakesNamesThatAreTimesForSeconds) {
  fs::create_directory(scratch / "timed");
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"frame_0000", "1305031102.95"}, {"frame_0003", "1305031103.45"}}) {
    fs::copy(scratch / ("tracked/" + from + ".ply"), scratch / ("timed/" + to + ".ply"));
  }
  fs::remove_all(scratch / "tracked");
  fs::rename(scratch / "timed", scratch / "tracked");
  ASSERT_EQ(animate().status, kDone);
  EXPECT_NEAR(end_of(document()), 0.5, 1e-6);
  EXPECT_THAT(animate({"--rate", "50"}).err, HasSubstr("leave out --rate"));
}

TEST_F(ExportAnimation, RefusesWhatIsNoSequence) {
  const auto refuses = [&](const std::vector<std::string>& options, const std::string& why) {
    fs::remove(scratch / "motion.glb");
    const CommandResult refused = animate(options);
    EXPECT_EQ(refused.status, kWrongCall);
    EXPECT_THAT(refused.err, HasSubstr(why));
    EXPECT_FALSE(fs::exists(scratch / "motion.glb"));
  };
  refuses({"--every", "9"}, "--every takes one of 4");
  refuses({"--title", "sheet"}, "--title: is that of a page");
  refuses({"--color"}, "--color works for range maps");
  refuses({"--rate", "0"}, "--rate: is 0; it must be > 0");
  geometry::write_mesh(scratch / "tracked/frame_0005.ply", geometry::test::flat_sheet(3, 3, 5));
  refuses({}, "frame_0005.ply: has 16 vertices and 18 triangles, not the same as");
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch / "tracked"))
    if (entry.path().filename() != "frame_0000.ply") fs::remove(entry.path());
  refuses({}, "at least two meshes; the folder has one. Export");
  fs::remove(scratch / "tracked/frame_0000.ply");
  refuses({}, "is empty");
  write_text(scratch / "tracked/notes.txt", "none");
  refuses({}, "or meshes, as palpate track writes them");
}

TEST_F(ExportAnimation, IsForFoldersOfMeshesAlone) {
  const std::string mesh = scratch / "tracked/frame_0000.ply";
  EXPECT_THAT(run_palpate({"export", mesh, "--glb", "--rate", "5", "-o", scratch / "a.glb"}).err,
              HasSubstr("--rate: is for a folder of meshes"));
  EXPECT_THAT(run_palpate({"export", mesh, "--glb", "--every", "5", "-o", scratch / "a.glb"}).err,
              HasSubstr("or of a folder of meshes as --glb"));
  EXPECT_THAT(run_palpate({"export", scratch / "tracked", "--ply", "-o", scratch / "a.ply"}).err,
              HasSubstr("--glb makes an animation"));
}

}  // namespace
}  // namespace palpate::apps
