// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Parts of a sequence by --shard, and palpate merge-shards: the same results as without.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "palpate/core/file_fingerprint.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

class Shards : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(scratch / "colors.yaml", trained_colors());
    fs::create_directory(scratch / "frames");
    for (const char* name : {"1.png", "2.png", "10.png"})
      fs::copy(demo("frames/flag_a.png"), scratch / std::string("frames/").append(name));
    write_text(scratch / "frames/11.png", "this is no image");
  }

  CommandResult decode(const std::string& output, const Words& more) const {
    Words call = {"decode",
                  scratch / "frames",
                  "--rig",
                  demo("rig.yaml"),
                  "--pattern",
                  demo("pattern.yaml"),
                  "--colors",
                  scratch / "colors.yaml",
                  "-o",
                  scratch / output,
                  "--half-resolution"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  CommandResult merge(const std::string& output, const Words& more = {}) const {
    Words call = {"merge-shards", scratch / output};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  void decode_shards(const std::string& output, const Words& shards) const {
    for (const std::string& shard : shards) {
      const CommandResult result = decode(output, {"--shard", shard});
      EXPECT_EQ(result.status, kDone) << result.err;
    }
  }

  /// All results with their content; in the record without the times that frames took.
  std::map<std::string, std::string> results(const std::string& output) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(scratch / output)) {
      const std::string name = entry.path().lexically_relative(scratch / output).string();
      if (entry.is_directory() || name.starts_with("shards/")) continue;
      files[name] = std::regex_replace(read_text(entry.path()), std::regex("\"ms\":[^,]*,"), "");
    }
    return files;
  }

  ScratchFolder scratch;
};

/// Figures without times and folders.
std::string timeless(const std::string& json, const std::string& folder) {
  std::string text =
      std::regex_replace(json, std::regex("\"(\\w*ms\\w*|frames_per_second)\": [^,\n]*"), "");
  for (std::size_t at = 0; (at = text.find(folder, at)) != std::string::npos;)
    text.erase(at, folder.size());
  return text;
}

void expect_error(const CommandResult& result, int status, const std::string& words) {
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
}

TEST_F(Shards, DecodedInAnyNumberAndOrderGiveTheSameBytes) {
  const CommandResult serial = decode("serial", {"--sigma", "--json", "--quiet"});
  EXPECT_EQ(serial.status, kWorkFailed) << "one frame is broken";
  const std::map<std::string, std::string> expected = results("serial");
  EXPECT_EQ(expected.size(), 9U);
  for (const Words& shards : {Words{"1/1"}, Words{"2/2", "1/2"},
                              Words{"5/7", "1/7", "7/7", "2/7", "4/7", "3/7", "6/7"}}) {
    const std::string output = std::to_string(shards.size());
    for (const std::string& shard : shards) {
      const CommandResult result = decode(output, {"--sigma", "--shard", shard, "--json"});
      EXPECT_EQ(result.status, kDone) << result.err;
    }
    const CommandResult merged = merge(output, {"--json", "--quiet", "--verify"});
    EXPECT_EQ(merged.status, kWorkFailed);
    EXPECT_EQ(merged.err, serial.err);
    EXPECT_EQ(timeless(merged.out, scratch / output), timeless(serial.out, scratch / "serial"));
    EXPECT_EQ(results(output), expected) << output;
  }
}

TEST_F(Shards, OfMeshesGiveTheSameBytes) {
  fs::remove(scratch / "frames/11.png");
  decode_shards("range", {"1/1"});
  write_text(scratch / "range/000003.tiff", "this is no range map");
  const auto mesh = [&](const std::string& output, Words more) {
    more.insert(more.begin(), {"mesh", scratch / "range", "-o", scratch / output, "--json",
                               "--quiet", "--smooth", "1"});
    return run_palpate(more);
  };
  const CommandResult serial = mesh("serial", {});
  EXPECT_EQ(results("serial").size(), 3U) << serial.err;
  for (const Words& shards : {Words{"1/1"}, Words{"2/2", "1/2"},
                              Words{"5/7", "1/7", "7/7", "2/7", "4/7", "3/7", "6/7"}}) {
    const std::string output = std::to_string(shards.size());
    for (const std::string& shard : shards)
      EXPECT_EQ(mesh(output, {"--shard", shard}).status, kDone);
    const CommandResult merged = merge(output, {"--json", "--quiet", "--verify"});
    EXPECT_EQ(merged.status, serial.status);
    EXPECT_EQ(merged.err, serial.err);
    EXPECT_EQ(timeless(merged.out, scratch / output), timeless(serial.out, scratch / "serial"));
    EXPECT_EQ(results(output), results("serial")) << output;
  }
}

TEST_F(Shards, OfMeshesAreDoneAgainWithAnotherMaskOrPicture) {
  for (const char* folder : {"range", "mask", "color"}) fs::create_directory(scratch / folder);
  write_text(scratch / "range/rig.yaml",
             "%YAML:1.0\n---\ncamera_size: [40, 30]\ncamera_matrix: !!opencv-matrix\n"
             "   rows: 3\n   cols: 3\n   dt: d\n"
             "   data: [100., 0., 19.5, 0., 100., 14.5, 0., 0., 1.]\ncamera_distortion: []\n");
  for (const std::string name : {"000000", "000001", "000002", "000003"}) {
    geometry::write_depth_tiff(scratch / ("range/" + name + ".tiff"),
                               geometry::ImageF::Constant(30, 40, 500));
    sensing::write_png(scratch / ("mask/" + name + ".png"), cv::Mat(30, 40, CV_8U, 255));
    sensing::write_png(scratch / ("color/" + name + ".png"), cv::Mat(30, 40, CV_8UC3, 100));
  }
  const auto is_kept = [&] {
    const CommandResult again = run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes",
                                             "--mask", scratch / "mask", "--color-images",
                                             scratch / "color", "--shard", "1/2", "--json"});
    EXPECT_EQ(again.status, kDone) << again.err;
    return nlohmann::json::parse(again.out)["kept"].get<bool>();
  };
  EXPECT_FALSE(is_kept());
  EXPECT_TRUE(is_kept());
  for (const std::string file : {"mask/000001.png", "color/000001.png"}) {
    cv::Mat picture = sensing::read_frame(scratch / file);
    picture.colRange(0, 10) = 0;
    sensing::write_png(scratch / file, picture);
    EXPECT_FALSE(is_kept()) << file;
    EXPECT_TRUE(is_kept()) << file;
  }
}

// A motion: each frame is blurred towards the next mesh, so that the first shard reads a mesh of
// the second one.
TEST_F(Shards, OfSimulatedMotionsGiveTheSameBytes) {
  for (const int depth : {700, 706}) {
    const std::string z = std::to_string(depth);
    write_text(scratch / ("card" + z + ".obj"), "v -40 -30 " + z + "\nv 40 -30 " + z +
                                                    "\nv 40 30 " + z + "\nv -40 30 " + z +
                                                    "\nf 1 3 2\nf 1 4 3\n");
  }
  const auto simulate = [&](const std::string& output, Words more) {
    more.insert(more.begin(),
                {"simulate", scratch / "card700.obj", scratch / "card706.obj", "--shutter", "0.5",
                 "--ideal", "--rig", demo("rig.yaml"), "--pattern", demo("pattern.yaml"), "-o",
                 scratch / output, "--json", "--quiet"});
    const CommandResult result = run_palpate(more);
    EXPECT_EQ(result.status, kDone) << result.err;
    return result.out;
  };
  const std::string serial = simulate("serial", {});
  const std::map<std::string, std::string> expected = results("serial");
  EXPECT_EQ(expected.size(), 3U + 2U + 6U + 6U) << "3 settings, frames, truth, training";
  simulate("2", {"--shard", "2/2"});
  simulate("2", {"--shard", "1/2"});
  const CommandResult merged = merge("2", {"--json", "--verify"});
  EXPECT_EQ(merged.status, kDone) << merged.err;
  EXPECT_EQ(timeless(merged.out, scratch / "2"), timeless(serial, scratch / "serial"));
  EXPECT_EQ(results("2"), expected);
}

TEST_F(Shards, ThatAreFinishedAreKeptUntilAFileChanges) {
  decode_shards("range", {"1/2"});
  const auto is_kept = [&] {
    const CommandResult again = decode("range", {"--shard", "1/2", "--json"});
    EXPECT_EQ(again.status, kDone) << again.err;
    return nlohmann::json::parse(again.out)["kept"].get<bool>();
  };
  EXPECT_TRUE(is_kept());
  fs::remove(scratch / "range/000001.tiff");
  EXPECT_FALSE(is_kept());
  EXPECT_TRUE(fs::exists(scratch / "range/000001.tiff"));
  write_text(scratch / "frames/1.png", read_text(demo("frames/flag_b.png")));
  EXPECT_FALSE(is_kept());
  EXPECT_TRUE(is_kept());
}

TEST_F(Shards, HaveNoJournalAfterAFullDiskAndGoOnOnceThereIsRoom) {
  (void)decode("serial", {});
  const CommandResult full =
      run_palpate({"decode", scratch / "frames", "--rig", demo("rig.yaml"), "--pattern",
                   demo("pattern.yaml"), "--colors", scratch / "colors.yaml", "-o",
                   scratch / "range", "--half-resolution", "--shard", "1/1"},
                  {.max_file_size = 20'000});
  EXPECT_EQ(full.status, kWorkFailed) << full.err;
  expect_error(merge("range"), kWorkFailed, "1 of 1 shards is missing");
  decode_shards("range", {"1/1"});
  (void)merge("range", {"--verify"});
  EXPECT_EQ(results("range"), results("serial"));
}

TEST_F(Shards, MayBeWrittenTwiceAtOnce) {
  (void)decode("serial", {});
  Words twins(3, "1/2");
  twins.emplace_back("2/2");
  std::vector<CommandResult> done(twins.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < twins.size(); ++i)
    threads.emplace_back([&, i] { done[i] = decode("range", {"--shard", twins[i]}); });
  for (std::thread& thread : threads) thread.join();
  for (const CommandResult& result : done) EXPECT_EQ(result.status, kDone) << result.err;
  (void)merge("range", {"--verify"});
  EXPECT_EQ(results("range"), results("serial"));
}

TEST_F(Shards, AreDoneAgainWhenAFrameThatWasMissingIsThere) {
  fs::remove(scratch / "frames/11.png");
  fs::remove(scratch / "frames/2.png");
  fs::create_symlink(scratch / "late.png", scratch / "frames/2.png");
  decode_shards("range", {"1/1"});
  EXPECT_EQ(merge("range").status, kWorkFailed) << "a frame is missing";
  fs::copy(demo("frames/flag_a.png"), scratch / "late.png");
  decode_shards("range", {"1/1"});
  const CommandResult merged = merge("range");
  EXPECT_EQ(merged.status, kDone) << merged.err;
}

TEST_F(Shards, ThatAreMissingAreNamedWithTheCallThatMakesThem) {
  decode_shards("range", {"2/4", "3/4"});
  const CommandResult missing = merge("range");
  expect_error(missing, kWorkFailed, "2 of 4 shards are missing: 1,4. Make shard 1, in ");
  expect_error(missing, kWorkFailed, " --output " + (scratch / "range") + " --shard 1/4\n");
  EXPECT_FALSE(fs::exists(scratch / "range/decode.jsonl"));

  const CommandResult preview = merge("range", {"--allow-missing", "--json"});
  EXPECT_EQ(preview.status, kDone) << preview.err;
  EXPECT_EQ(nlohmann::json::parse(preview.out)["frames"], 2);
  EXPECT_NE(preview.err.find("missing: 1,4"), std::string::npos) << preview.err;
  EXPECT_FALSE(fs::exists(scratch / "range/decode.jsonl")) << "the sequence is not complete";
}

TEST_F(Shards, OfAnotherCallOrOtherDataAreRefusedAndChangeNothing) {
  decode_shards("range", {"1/2"});
  const auto before = results("range");
  const auto refused = [&](const Words& more, const std::string& words) {
    expect_error(decode("range", more), kWrongCall, words);
    EXPECT_EQ(results("range"), before);
  };
  refused({"--shard", "2/3"}, "another number of shards: 2 then, 3 now");
  refused({"--shard", "2/2", "--sigma"}, "another --sigma: null then");
  refused({}, "holds shards that are not merged yet");
  fs::rename(scratch / "frames/1.png", scratch / "frames/3.png");
  refused({"--shard", "2/2"}, "another list of items");
  fs::rename(scratch / "frames/3.png", scratch / "frames/1.png");
  write_text(scratch / "colors.yaml", trained_colors() + "\n");
  refused({"--shard", "2/2"}, "another --colors");
  write_text(scratch / "colors.yaml", trained_colors());
  decode_shards("range", {"2/2"});

  const std::string journal = scratch / "range/shards/0002-of-0002.jsonl";
  const std::string whole = read_text(journal);
  write_text(journal,
             std::regex_replace(whole, std::regex(R"("version":"[^"]*")"), R"("version":"0.0.1")",
                                std::regex_constants::format_first_only));
  expect_error(merge("range"), kWrongCall, "another version");
  write_text(journal, whole.substr(0, whole.size() / 2));
  expect_error(merge("range"), kWrongCall, "is cut off: it lists 0 of its 2 items");
  decode_shards("range", {"2/2"});
  EXPECT_EQ(merge("range").status, kWorkFailed) << "one frame is broken";
  EXPECT_TRUE(fs::exists(scratch / "range/decode.jsonl"));
}

TEST_F(Shards, WhoseResultsChangedAreRefused) {
  decode_shards("range", {"1/2", "2/2"});
  const std::string map = scratch / "range/000002.tiff";
  std::string bytes = read_text(map);
  bytes[bytes.size() / 2] ^= 1;
  write_text(map, bytes);
  expect_error(merge("range", {"--verify"}), kWrongCall,
               "000002.tiff: was changed since shard 2/2 was finished");
  fs::remove(map);
  expect_error(merge("range"), kWrongCall, "000002.tiff: was removed since shard 2/2 was finished");
  EXPECT_FALSE(fs::exists(scratch / "range/decode.jsonl"));
}

TEST_F(Shards, DoNotReplaceResultsAndAreReplacedByARunOfTheWhole) {
  (void)decode("serial", {});
  const auto before = results("serial");
  expect_error(decode("serial", {"--shard", "1/2"}), kWrongCall, "shards do not replace results");
  EXPECT_EQ(results("serial"), before);
  decode_shards("range", {"1/2", "2/2"});
  (void)merge("range");
  fs::remove(scratch / "frames/11.png");
  const CommandResult again = decode("range", {});
  EXPECT_EQ(again.status, kDone) << again.err;
  expect_error(merge("range"), kWrongCall, "holds no shards");
}

TEST_F(Shards, AreJudgedTogether) {
  std::string shifted = read_text(demo("pattern.yaml"));
  const std::string right = "\nphase: 0.0\n";
  shifted.replace(shifted.find(right), right.size(), "\nphase: 1.5707963\n");
  write_text(scratch / "pattern.yaml", shifted);
  fs::remove(scratch / "frames/11.png");
  for (const char* shard : {"1/2", "2/2"}) {
    const CommandResult result =
        run_palpate({"decode", scratch / "frames", "--rig", demo("rig.yaml"), "--pattern",
                     scratch / "pattern.yaml", "--colors", scratch / "colors.yaml", "-o",
                     scratch / "range", "--shard", shard});
    EXPECT_EQ(result.status, kDone) << "only the merge sees all frames";
    EXPECT_NE(result.err.find("of this shard do not fit"), std::string::npos) << result.err;
  }
  expect_error(merge("range"), kWorkFailed, "merge again with --force");
  EXPECT_EQ(merge("range", {"--force"}).status, kDone);
}

TEST_F(Shards, AreRefusedWhereThereAreNoItems) {
  write_text(scratch / "wave.avi", "");
  expect_error(run_palpate({"decode", scratch / "wave.avi", "--rig", demo("rig.yaml"), "--pattern",
                            demo("pattern.yaml"), "--colors", scratch / "colors.yaml", "-o",
                            scratch / "range", "--shard", "1/2"}),
               kWrongCall, "wave.avi");
  expect_error(
      run_palpate({"mesh", demo("sheet/surface.ply"), "-o", scratch / "a.ply", "--shard", "1/2"}),
      kWrongCall, "--shard: works for a sequence");
  expect_error(decode("range", {"--shard", "1/2", "--resume"}), kWrongCall, "--resume");
  expect_error(merge("frames"), kWrongCall, "holds no shards");
}

}  // namespace
}  // namespace palpate::apps
