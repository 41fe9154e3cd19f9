// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// No command overwrites its input, or removes files that it did not write.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

class KeptFiles : public ::testing::Test {
 protected:
  /// A file that was not written by a command; parents are made.
  std::string put(const std::string& name, const std::string& text = "precious") const {
    fs::create_directories(fs::path(scratch / name).parent_path());
    write_text(scratch / name, text);
    return scratch / name;
  }

  /// All files by their paths, with their content.
  std::map<std::string, std::string> content() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(scratch.path()))
      if (entry.is_regular_file()) files[entry.path().string()] = read_text(entry.path());
    return files;
  }

  /// Expects status 2, a message with `place` and unchanged files. Returns the message.
  std::string expect_refused(const std::vector<std::string>& call, const std::string& place) const {
    const auto before = content();
    const CommandResult result = run_palpate(call);
    std::string line;
    for (const std::string& word : call) line += word + " ";
    EXPECT_EQ(result.status, kWrongCall) << line << "\n" << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos) << line << "\n" << result.err;
    EXPECT_EQ(content(), before) << line;
    return result.err;
  }

  std::vector<std::string> simulate_call(const std::string& output) const {
    return {"simulate",  (demo_data().parent_path() / "meshes/hand.ply").string(),
            "--rig",     demo("rig.yaml"),
            "--pattern", demo("pattern.yaml"),
            "-o",        output};
  }

  ScratchFolder scratch;
};

TEST_F(KeptFiles, NoOutputIsOrLiesInAnInput) {
  fs::copy(demo("training"), scratch / "training");
  fs::copy(demo("frames"), scratch / "white");
  fs::copy(demo("sheet"), scratch / "sheet");
  fs::create_directories(scratch / "own");
  fs::copy(demo("rig.yaml"), scratch / "own/rig.yaml");
  fs::create_directory_symlink(scratch / "training", scratch / "link");
  fs::create_symlink(scratch / "white/plane.png", scratch / "linked.png");
  for (const char* pose : {"0", "1", "2"})
    put(std::string("poses/") + pose + "/graycode_00.jpg", "a picture");
  const std::string s = scratch / "";
  const std::string pattern = demo("pattern.yaml"), rig = demo("rig.yaml");
  const std::vector<std::string> colors = {"calibrate", "colors", s + "training"};
  const std::vector<std::string> chromatic = {"calibrate", "chromatic", s + "white",       "--rig",
                                              rig,         "--pattern", s + "own/rig.yaml"};
  const std::vector<std::string> poses = {"calibrate", "rig", s + "poses",        "--board", "7x9",
                                          "--square",  "25",  "--projector-size", "320x240"};
  const std::vector<std::string> decode = {"decode", s + "white", "--rig",
                                           rig,      "--pattern", pattern};
  const std::vector<std::string> fit = {"fit", s + "sheet/a.db", s + "sheet/surface.ply"};
  struct Case {
    std::vector<std::string> call, outputs;
  };
  const std::vector<Case> cases = {
      {colors, {"-o", s + "training/R_flat.png"}},
      {colors, {"-o", s + "training"}},
      {colors, {"-o", s + "link/new.yaml"}},
      {colors, {"-o", s + "new.yaml", "--picture", s + "training/../training/R_flat.png"}},
      {chromatic, {"-o", s + "white/plane.png"}},
      {chromatic, {"-o", s + "own/rig.yaml"}},
      {poses, {"-o", s + "poses/0/graycode_00.jpg"}},
      {poses, {"-o", s + "new.yaml", "--picture", s + "poses/0/graycode_00.jpg"}},
      {decode, {"-o", s + "white"}},
      {decode, {"-o", s + "white/range/"}},
      {{"decode", s + "white/plane.png", "--rig", rig, "--pattern", pattern}, {"-o", s + "white"}},
      {{"decode", s + "linked.png", "--rig", rig, "--pattern", pattern}, {"-o", s + "white"}},
      {{"mesh", s + "white"}, {"-o", s + "white/meshes"}},
      {{"mesh", s + "sheet/surface.ply"}, {"-o", s + "sheet/surface.ply"}},
      {fit, {"-o", s + "sheet"}},
      {{"pattern", "--rig", s + "own/rig.yaml"}, {"-o", s + "own"}},
      {{"probe", "import", s + "sheet/contacts.csv", s + "sheet/samples.csv"},
       {"-o", s + "sheet/samples.csv"}},
      {{"export", s + "sheet", "--json"}, {"-o", s + "sheet/field.json"}},
      {{"simulate", s + "sheet/surface.ply", "--rig", rig, "--pattern", pattern},
       {"-o", s + "sheet"}},
      {{"compare", s + "sheet/surface.ply", s + "own/rig.yaml"}, {"--picture", s + "own/rig.yaml"}},
  };
  for (const Case& one : cases) {
    std::vector<std::string> call = one.call;
    call.insert(call.end(), one.outputs.begin(), one.outputs.end());
    // The reason is the place, not another fault of these files, which are stand-ins.
    const std::string reason = expect_refused(call, one.outputs.back());
    EXPECT_TRUE(reason.find("already used in this call") != std::string::npos ||
                reason.find("which would be replaced") != std::string::npos ||
                reason.find("results could replace frames of the same name") != std::string::npos)
        << reason;
  }
}

TEST_F(KeptFiles, MeasurementsAreNotReplacedByOthers) {
  const std::string contacts = demo("sheet/contacts.csv"), samples = demo("sheet/samples.csv"),
                    campaign = scratch / "campaign.db", plan = scratch / "plan.json",
                    specimen = scratch / "sheet.json";
  write_text(specimen, R"({"type": "sheet"})");
  ASSERT_EQ(run_palpate({"probe", "plan", "--specimen", specimen, "-o", plan, "--contacts", "1",
                         "--levels", "1", "--directions", "1"})
                .status,
            kDone);
  ASSERT_EQ(run_palpate({"probe", "run", plan, "--specimen", specimen, "-o", campaign}).status,
            kDone);
  expect_refused({"probe", "import", contacts, samples, "-o", campaign}, "campaign.db: holds a");
  expect_refused({"bake", specimen, "-o", scratch / "model", "--acquisition", campaign},
                 "campaign.db: holds a");
  put("scan.ply", "a mesh");
  expect_refused({"probe", "import", contacts, samples, "-o", scratch / "scan.ply"},
                 "scan.ply: is no database");
  put("own/samples.csv", "raw data");
  expect_refused({"probe", "export", campaign, "-o", scratch / "own"}, "own/samples.csv: is there");
}

TEST_F(KeptFiles, SimulateReplacesOnlyAFolderOfItsOwn) {
  const std::string out = scratch / "real";
  put("real/frames/000000.png");
  expect_refused(simulate_call(out), "no sensor.yaml");
  put("real/frames/precious.png");
  expect_refused(simulate_call(out), "frames/precious.png");
  fs::remove_all(out);
  ASSERT_EQ(run_palpate(simulate_call(out)).status, kDone);
  fs::create_directories(out + "/report");  // as left by --report, which this call omits
  const CommandResult again = run_palpate(simulate_call(out));
  EXPECT_EQ(again.status, kDone) << again.err;
  EXPECT_FALSE(fs::exists(out + "/report"));
  put("real/training/000000/notes.txt");
  expect_refused(simulate_call(out), "training/000000/notes.txt");
}

TEST_F(KeptFiles, PatternReplacesAPatternOfOtherColoursAndNothingElse) {
  const auto call = [&](const std::string& colors) {
    return std::vector<std::string>{"pattern", "--size", "256",        "192", "--number-of-colors",
                                    colors,    "-o",     scratch / "p"};
  };
  ASSERT_EQ(run_palpate(call("6")).status, kDone);
  const CommandResult again = run_palpate(call("3"));
  EXPECT_EQ(again.status, kDone) << again.err;
  int flat = 0;
  for (const auto& entry : fs::directory_iterator(scratch / "p"))
    flat += static_cast<int>(entry.path().string().ends_with("_flat.png"));
  EXPECT_EQ(flat, 4);  // three colours and white
  put("p/notes.txt");
  expect_refused(call("6"), "notes.txt");
  fs::remove(scratch / "p/notes.txt");
  fs::remove(scratch / "p/pattern.yaml");
  expect_refused(call("6"), "no pattern.yaml");
}

TEST_F(KeptFiles, ImagesToProjectAreNotDrawnOverViewsOfThem) {
  put("poses/0/graycode_00.png");
  const std::vector<std::string> call = {"calibrate", "rig", "--projector-size", "320x240",
                                         "--draw"};
  auto into = [&](const std::string& folder) {
    std::vector<std::string> whole = call;
    whole.push_back(scratch / folder);
    return whole;
  };
  expect_refused(into("poses/0"), "graycode_00.png");
  const CommandResult drawn = run_palpate(into("show"));
  EXPECT_EQ(drawn.status, kDone) << drawn.err;
  EXPECT_TRUE(fs::exists(scratch / "show/projected.png"));
}

TEST_F(KeptFiles, AnEmptyNameIsAWrongCall) {
  expect_refused({"pattern", "-o", ""}, "empty");
  expect_refused({"calibrate", "colors", demo("training"), "-o", ""}, "empty");
  expect_refused({"mesh", "", "-o", scratch / "new.ply"}, "empty");
}

}  // namespace
}  // namespace palpate::apps
