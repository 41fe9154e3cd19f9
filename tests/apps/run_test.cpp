// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate run`: the whole way, only what changed, interrupted and continued.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_palpate.h"
#include "shared/result_folder.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Run : public ::testing::Test {
 protected:
  static constexpr int kContacts = 6;

  /// A project of quick steps, with its data.
  void SetUp() override {
    write_text(scratch / "contacts.csv",
               lines_below(read_text(demo("sheet/contacts.csv")), 0, kContacts));
    write_text(scratch / "samples.csv",
               lines_below(read_text(demo("sheet/samples.csv")), 1, kContacts));
    fs::copy(demo("sheet/surface.ply"), scratch / "scan.ply");
    fs::copy(demo("trajectory.csv"), scratch / "trajectory.csv");
    write_project(kQuick);
  }

  void write_project(const std::string& text) const { write_text(scratch / "project.yaml", text); }

  CommandResult run(std::vector<std::string> more = {}, const CommandOptions& options = {}) const {
    more.insert(more.begin(), {"run", scratch / "project.yaml"});
    return run_palpate(more, options);
  }

  /// Runs with --json and expects success: the entry of each step.
  std::map<std::string, json> steps(std::vector<std::string> more = {}) const {
    more.emplace_back("--json");
    const CommandResult result = run(std::move(more));
    EXPECT_EQ(result.status, kDone) << result.err;
    return by_step(result.out);
  }

  static std::map<std::string, json> by_step(const std::string& out) {
    std::map<std::string, json> entries;
    const json figures = json::parse(out);
    for (const json& entry : figures.at("steps")) entries[entry.at("step")] = entry;
    return entries;
  }

  /// "mesh done, fit unchanged", in the order of the steps.
  static std::string in_words(const std::string& out) {
    std::string words;
    const json figures = json::parse(out);
    for (const json& entry : figures.at("steps")) {
      words += (words.empty() ? "" : ", ") + entry.at("step").get<std::string>() + " " +
               entry.at("status").get<std::string>();
    }
    return words;
  }

  /// The same of a run that succeeds.
  std::string statuses(std::vector<std::string> more = {}) const {
    more.emplace_back("--json");
    const CommandResult result = run(std::move(more));
    EXPECT_EQ(result.status, kDone) << result.err;
    return in_words(result.out);
  }

  /// All files by their paths, with what is in them.
  std::map<std::string, std::string> content() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(scratch.path()))
      if (entry.is_regular_file()) files[entry.path().string()] = read_text(entry.path());
    return files;
  }

  /// The run has status 2, says `words`, and changes no file.
  void expect_refused(const std::string& words, std::vector<std::string> more = {}) const {
    const auto before = content();
    const CommandResult result = run(std::move(more));
    EXPECT_EQ(result.status, kWrongCall) << words << "\n" << result.out << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(content(), before) << words;
  }

  void replace_in(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = read_text(scratch / file);
    ASSERT_NE(text.find(from), std::string::npos) << from;
    write_text(scratch / file, text.replace(text.find(from), from.size(), to));
  }

  static constexpr const char* kQuick =
      "mesh:   {range: scan.ply}\n"
      "import: {data: [contacts.csv, samples.csv]}\n"
      "fit:    {max-bases: 1, passive: local}\n"
      "play:   {trajectory: trajectory.csv}\n"
      "export: {obj: true}\n";
  static constexpr const char* kAllUnchanged =
      "mesh unchanged, import unchanged, fit unchanged, play unchanged, export unchanged";
  ScratchFolder scratch;
};

TEST_F(Run, GoesTheWholeWayFromTheBundledFramesToForces) {
  const fs::path folder = scratch / "eins/zwei/drei Ordner/äöü/fünf";
  fs::create_directories(folder.parent_path());
  fs::copy(demo(""), folder, fs::copy_options::recursive);
  const std::vector<std::string> call = {"run", folder / "project.yaml", "-o", scratch / "out"};
  const CommandResult first = run_palpate(call);
  ASSERT_EQ(first.status, kDone) << first.err;
  EXPECT_THAT(first.out, AllOf(HasSubstr("decode    done"), HasSubstr("4 of 4 frames"),
                               HasSubstr("(not done before)"), HasSubstr("8 steps: 8 done\n")));
  for (const char* file :
       {"out/colors.yaml", "out/range/000000.tiff", "out/surface.ply", "out/acquisition.db",
        "out/model/field.json", "out/trace.csv", "out/model.html", "out/project.run"})
    EXPECT_TRUE(fs::exists(scratch / file)) << file;
  EXPECT_FALSE(fs::exists(folder / "project.run"));
  const auto done = content();
  const CommandResult second = run_palpate(call);
  EXPECT_EQ(second.status, kDone) << second.err;
  EXPECT_THAT(second.out, AllOf(HasSubstr("4 of 4 frames"), HasSubstr("8 steps: 8 unchanged\n")));
  EXPECT_EQ(content(), done);
  // A step is the call that one would make.
  ASSERT_EQ(run_palpate({"mesh", scratch / "out/range/000000.tiff", "-o", scratch / "by_hand.ply"})
                .status,
            kDone);
  EXPECT_EQ(read_text(scratch / "by_hand.ply"), read_text(scratch / "out/surface.ply"));
}

TEST_F(Run, GivesTheFiguresOfItsSteps) {
  auto first = steps();
  EXPECT_EQ(first["import"]["figures"]["contacts"], 6);
  EXPECT_EQ(first["fit"]["figures"]["per_contact"].size(), 6U);
  EXPECT_EQ(first["fit"]["reason"], "not done before");
  EXPECT_GT(first["fit"]["seconds"], 0);
  auto second = steps();
  EXPECT_EQ(second["fit"]["figures"], first["fit"]["figures"]);
  EXPECT_EQ(second["fit"]["reason"], json());
  EXPECT_EQ(second["fit"]["seconds"], 0);
  EXPECT_EQ(run({"-q"}).out, "");
}

TEST_F(Run, DoesAgainOnlyWhatFollowsFromAChange) {
  steps();
  EXPECT_EQ(statuses(), kAllUnchanged);
  replace_in("project.yaml", "max-bases: 1", "max-bases: 2");
  auto changed = steps({"--dry-run"});
  EXPECT_EQ(changed["fit"]["status"], "due");
  EXPECT_EQ(changed["fit"]["reason"], "max-bases was 1, is 2");
  EXPECT_EQ(changed["play"]["status"], "depends");
  EXPECT_EQ(statuses(), "mesh unchanged, import unchanged, fit done, play done, export done");
  EXPECT_EQ(statuses(), kAllUnchanged);
  // Times do not matter.
  fs::last_write_time(scratch / "scan.ply", fs::file_time_type::clock::now());
  EXPECT_EQ(statuses(), kAllUnchanged);
  replace_in("trajectory.csv", "\n", "\r\n");
  EXPECT_EQ(steps()["play"]["reason"], "trajectory.csv changed");
  fs::remove(scratch / "trace.csv");
  EXPECT_EQ(steps()["play"]["reason"], "trace.csv is missing");
  // A comment or another order is no change.
  write_project(
      "export: {obj: true}\n"
      "# mine\n"
      "play:   {trajectory: trajectory.csv}\n"
      "fit:    {passive: 'local', max-bases: 2}\n"
      "import: {data: [contacts.csv, samples.csv]}\n"
      "mesh:   {range: scan.ply}\n");
  EXPECT_EQ(statuses(), kAllUnchanged);
}

TEST_F(Run, StepsAreSkippedIfAnEarlierOneMakesTheSameAgain) {
  steps();
  replace_in("project.yaml", "range: scan.ply", "range: scan.ply, smooth: 0");
  EXPECT_EQ(statuses({"--dry-run"}),
            "mesh due, import unchanged, fit depends, play depends, export depends");
  EXPECT_EQ(statuses(),
            "mesh done, import unchanged, fit unchanged, play unchanged, export unchanged");
}

TEST_F(Run, FollowsASurfaceThroughDepthImages) {
  for (const char* name : {"000000.png", "000001.png", "000002.png"}) {
    fs::create_directories(scratch / "depth");
    fs::copy(demo("depth_sequence/depth/") + name, scratch / ("depth/" + std::string(name)));
  }
  fs::copy(demo("depth_sequence/camera.json"), scratch / "camera.json");
  const std::string camera = "rig: camera.json, scale: 1";
  write_project("motion: {rate: 30}\nexport: {html: true}\ntrack: {range_folder: depth, " + camera +
                "}\nfuse: {scan: depth/000000.png, spacing: 4, " + camera + "}\n");
  const CommandResult first = run();
  ASSERT_EQ(first.status, kDone) << first.err;
  EXPECT_THAT(first.out, AllOf(HasSubstr("triangles of 1 scan "), HasSubstr("3 of 3 frames, RMS"),
                               HasSubstr("3 meshes"), HasSubstr("motion.html"),
                               HasSubstr("4 steps: 4 done\n")));
  // The reference is what was fused.
  const auto triangles = [&](const char* mesh) {
    return json::parse(run_palpate({"info", scratch / mesh, "--json"}).out).at("triangles");
  };
  EXPECT_EQ(triangles("tracked/000000.ply"), triangles("fused.ply"));
  EXPECT_EQ(statuses(), "fuse unchanged, track unchanged, motion unchanged, export unchanged");
}

// Options of 'palpate cloud' are steps: a plane is found before or after points are left out.
TEST_F(Run, DoesTheStepsOfACloudInTheOrderOfTheFile) {
  const std::string point = "cloud: {points: scan.ply, ";
  write_project(point + "voxel: 2, outliers: 3}");
  const auto steps_of = [](const json& entry) {
    std::string names;
    for (const json& step : entry.at("figures").at("steps"))
      names += step.at("step").get<std::string>() + " ";
    return names;
  };
  EXPECT_EQ(steps_of(steps()["cloud"]), "voxel outliers ");
  write_project(point + "outliers: 3, voxel: 2}");
  const json again = steps()["cloud"];
  EXPECT_EQ(again["reason"],
            "order of entries was points, voxel, outliers, is points, outliers, voxel");
  EXPECT_EQ(steps_of(again), "outliers voxel ");
}

TEST_F(Run, ReadsTheRangeMapsThatACampaignRecords) {
  for (const char* name : {"rig.yaml", "pattern.yaml", "pattern.png"})
    fs::copy(demo(name), scratch / name);
  fs::copy(demo("training"), scratch / "training");
  write_text(scratch / "body.json", R"({"type": "elastic_body"})");
  const std::string probe =
      "colors: {folder: training}\nplan: {specimen: body.json}\n"
      "probe: {specimen: body.json, output: seen/acquisition.db";
  const std::string camera =
      ", camera: simulated, rig: rig.yaml, pattern: pattern.yaml, colors: colors.yaml}";
  const std::string track = "\ntrack: {acquisition: seen/acquisition.db, reference: scan.ply}\n";
  write_project(probe + camera + track);
  const CommandResult planned = run({"--dry-run", "-v"});
  EXPECT_EQ(planned.status, kDone) << planned.err;
  EXPECT_THAT(planned.err, HasSubstr("palpate track seen/range "));
  EXPECT_THAT(planned.out, HasSubstr("track     due"));
  write_project(probe + "}" + track);
  expect_refused("track: range_folder is missing", {"--dry-run"});
  // Two steps do not write into one folder.
  write_project("decode: {frames: training, rig: rig.yaml, pattern: pattern.yaml}\n" + probe +
                camera);
  replace_in("project.yaml", "output: seen/acquisition.db", "output: acquisition.db");
  expect_refused("range: is, holds or lies in range, which decode writes", {"--dry-run"});
}

TEST_F(Run, KeepsItsResultsIfTheFolderIsMoved) {
  steps();
  const ScratchFolder other;
  fs::copy(scratch.path(), other / "moved", fs::copy_options::recursive);
  const CommandResult moved = run_palpate({"run", other / "moved/project.yaml", "--json"});
  EXPECT_EQ(in_words(moved.out), kAllUnchanged) << moved.err;
}

TEST_F(Run, WritesIntoAnotherFolderIfAsked) {
  const auto before = content();
  EXPECT_EQ(statuses({"-o", scratch / "out"}),
            "mesh done, import done, fit done, play done, export done");
  EXPECT_EQ(statuses({"-o", scratch / "out"}), kAllUnchanged);
  EXPECT_TRUE(fs::exists(scratch / "out/model/field.json"));
  fs::remove_all(scratch / "out");
  EXPECT_EQ(content(), before);
  write_project("output: results\n" + std::string(kQuick));
  steps();
  EXPECT_TRUE(fs::exists(scratch / "results/project.run"));
  // What a step makes is found in that folder by those that follow.
  replace_in("project.yaml", "fit:    {", "fit:    {surface: surface.ply, ");
  EXPECT_EQ(statuses(), kAllUnchanged);
}

TEST_F(Run, NothingIsWrittenWithDryRun) {
  const auto before = content();
  const CommandResult plan = run({"--dry-run", "-v", "-o", scratch / "out"});
  EXPECT_EQ(plan.status, kDone) << plan.err;
  EXPECT_THAT(plan.out, HasSubstr("5 steps: 5 due\n"));
  EXPECT_THAT(plan.err, HasSubstr("palpate fit out/acquisition.db out/surface.ply "));
  EXPECT_EQ(content(), before);
}

TEST_F(Run, StepsReadFromOtherFoldersWhatEarlierOnesWriteThere) {
  // Under another folder of the root than the project, which is the farthest away.
  const CommandResult plan = run({"--dry-run", "-v", "-o", "/no such folder/out"});
  EXPECT_EQ(plan.status, kDone) << plan.err;
  const std::string out = fs::path("/no such folder/out").lexically_relative(scratch.path());
  EXPECT_THAT(plan.err, AllOf(HasSubstr("palpate fit " + out + "/acquisition.db " + out),
                              HasSubstr("palpate play " + out + "/model "),
                              HasSubstr("palpate export " + out + "/model ")));
}

TEST_F(Run, GoesOnAfterCtrlCAndAfterAKill) {
  write_project(
      "import: {data: [contacts.csv, samples.csv]}\n"
      "fit:    {surface: scan.ply}\n"
      "export: {json: true}\n");
  steps({"-o", scratch / "whole"});
  for (const int signal : {SIGINT, SIGKILL}) {
    const std::string output = scratch / ("out" + std::to_string(signal));
    const CommandResult stopped =
        run({"-o", output, "--threads", "1"},
            {.interrupt_when_there_is = output + "/model.fits", .signal = signal});
    ASSERT_EQ(stopped.status, signal == SIGINT ? kInterrupted : 128 + SIGKILL) << stopped.err;
    if (signal == SIGINT) {
      EXPECT_THAT(stopped.err, HasSubstr("to continue, call palpate run again"));
    }
    ASSERT_FALSE(fs::exists(output + "/model"));
    EXPECT_EQ(statuses({"-o", output, "--status"}),
              signal == SIGINT ? "import done, fit failed, export missing"
                               : "import done, fit interrupted, export missing");
    const std::string kept = read_text(output + "/model.fits");
    auto rest = steps({"-o", output});
    EXPECT_EQ(rest["import"]["status"], "unchanged");
    EXPECT_EQ(rest["fit"]["status"], "done");
    EXPECT_EQ(rest["fit"]["reason"], "it did not finish");
    EXPECT_EQ(rest["fit"]["figures"]["kept"], std::ranges::count(kept, '\n') - 1);  // its head
    EXPECT_EQ(read_text(output + "/model/field.json"),
              read_text(scratch / "whole/model/field.json"));
  }
}

TEST_F(Run, BeginsAnInterruptedStepAnewIfAnInputHasChanged) {
  write_project(
      "import: {data: [contacts.csv, samples.csv]}\n"
      "fit:    {surface: scan.ply}\n");
  const CommandOptions interrupt = {.interrupt_when_there_is = scratch / "model.fits"};
  ASSERT_EQ(run({"--threads", "1"}, interrupt).status, kInterrupted);
  replace_in("project.yaml", "scan.ply}", "scan.ply, accuracy: 0.5}");
  auto rest = steps();
  EXPECT_EQ(rest["fit"]["reason"], "it did not finish, and 1 more change");
  EXPECT_EQ(rest["fit"]["figures"]["kept"], 0);
}

TEST_F(Run, GoesOnWithFitsOfOtherSettingsByBeginningAnew) {
  // A step that ended before its command kept anything: what is kept is of an older run.
  write_project(
      "import: {data: [contacts.csv, samples.csv]}\n"
      "fit:    {surface: scan.ply}\n");
  const CommandOptions interrupt = {.interrupt_when_there_is = scratch / "model.fits"};
  ASSERT_EQ(run({"--threads", "1"}, interrupt).status, kInterrupted);
  json record = json::parse(read_text(scratch / "project.run"));
  record["steps"]["fit"]["entries"]["accuracy"] = {{"0.5"}};
  write_text(scratch / "project.run", record.dump());
  replace_in("project.yaml", "scan.ply}", "scan.ply, accuracy: 0.5}");
  auto rest = steps();
  EXPECT_EQ(rest["fit"]["reason"], "it did not finish");
  EXPECT_EQ(rest["fit"]["figures"]["kept"], 0);
}

TEST_F(Run, ContinuesACampaignAndNeverReplacesIt) {
  write_text(scratch / "sheet.json", R"({"type": "sheet"})");
  write_project(
      "plan:  {specimen: sheet.json, contacts: 2, levels: 2, directions: 2}\n"
      "probe: {specimen: sheet.json}\n");
  const json whole = steps({"-o", scratch / "whole"})["probe"]["figures"];
  const CommandResult stopped =
      run({}, {.interrupt_when_there_is = scratch / "acquisition.db", .signal = SIGKILL});
  ASSERT_EQ(stopped.status, 128 + SIGKILL) << stopped.err;
  EXPECT_EQ(steps()["probe"]["figures"]["fingerprint"], whole["fingerprint"]);
  EXPECT_EQ(statuses(), "plan unchanged, probe unchanged");
  replace_in("project.yaml", "levels: 2", "levels: 3");
  const std::string measured = read_text(scratch / "acquisition.db");
  const CommandResult refused = run();
  EXPECT_EQ(refused.status, kWrongCall);
  EXPECT_THAT(refused.err, HasSubstr("acquisition.db: holds measurements"));
  EXPECT_EQ(read_text(scratch / "acquisition.db"), measured);
}

TEST_F(Run, GoesOnWithAStepThatFailed) {
  replace_in("contacts.csv", "\n", "\nx");
  const CommandResult failed = run({"--json"});
  EXPECT_EQ(failed.status, kWrongCall);
  EXPECT_THAT(failed.err, HasSubstr("contacts.csv: line 2"));
  EXPECT_EQ(in_words(failed.out), "mesh done, import failed");
  replace_in("contacts.csv", "\nx", "\n");
  // Made by hand in the meantime:
  write_text(scratch / "acquisition.db", "precious");
  expect_refused("acquisition.db: is there, but palpate run did not write it");
  fs::remove(scratch / "acquisition.db");
  EXPECT_EQ(statuses(), "mesh unchanged, import done, fit done, play done, export done");
}

TEST_F(Run, ReplacesNoFileThatItDidNotWrite) {
  write_text(scratch / "trace.csv", "precious");
  expect_refused("trace.csv: is there, but palpate run did not write it, and step 'play' would");
  fs::remove(scratch / "trace.csv");
  steps();
  write_text(scratch / "model/field.json", "precious");
  expect_refused("model/field.json: was changed after palpate run wrote it, and step 'fit' would");
  fs::remove(scratch / "model/field.json");
  EXPECT_EQ(statuses(),
            "mesh unchanged, import unchanged, fit done, play unchanged, export unchanged");
  // A file of others does not keep a step from being skipped, but from being done.
  write_text(scratch / "model/notes.txt", "precious");
  EXPECT_EQ(steps()["fit"]["status"], "unchanged");
  replace_in("project.yaml", "max-bases: 1", "max-bases: 2");
  expect_refused("model/notes.txt: is there, but palpate run did not write it");
}

TEST_F(Run, ASecondRunOfTheSameProjectIsRefused) {
  const FolderLock lock(scratch.path());
  const CommandResult second = run();
  EXPECT_EQ(second.status, kWorkFailed);
  EXPECT_THAT(second.err, HasSubstr("another run of palpate is writing into this folder"));
  EXPECT_FALSE(fs::exists(scratch / "project.run"));
  EXPECT_EQ(run({"--dry-run"}).status, kDone);
}

TEST_F(Run, TellsItsStatusWhileItRunsWithoutChangingAnything) {
  EXPECT_EQ(statuses({"--status"}),
            "mesh missing, import missing, fit missing, play missing, export missing");
  EXPECT_FALSE(fs::exists(scratch / "project.run"));
  steps();
  const std::string all_done = "mesh done, import done, fit done, play done, export done";
  EXPECT_EQ(statuses({"--status"}), all_done);
  replace_in("project.run", "\"done\"", "\"begun\"");  // of the first step by name, export
  const FolderLock lock(scratch.path());
  EXPECT_EQ(statuses({"--status"}), "mesh done, import done, fit done, play done, export running");
  EXPECT_EQ(run({"--status", "--dry-run"}).status, kWrongCall);
}

TEST_F(Run, SaysIfItCannotWrite) {
  const CommandResult full = run({}, {.max_file_size = 100});
  EXPECT_EQ(full.status, kWorkFailed);
  EXPECT_THAT(full.err, HasSubstr("project.run: cannot be written"));
  EXPECT_FALSE(fs::exists(scratch / "surface.ply"));
  EXPECT_EQ(run({"-o", scratch / "project.yaml/out"}).status, kWorkFailed);
  if (geteuid() == 0) return;  // root may write everywhere
  fs::permissions(scratch.path(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(run().status, kWorkFailed);
  fs::permissions(scratch.path(), fs::perms::owner_all);
}

TEST_F(Run, RefusesAWrongProjectBeforeTheFirstStep) {
  struct Case {
    const char *section, *words;
  };
  const Case cases[] = {
      {"expotr: {obj: true}", "line 5: expotr: is unknown; did you mean export?"},
      {"carve: {}", "line 5: carve: is unknown; expected colors, decode, mesh, "},
      {"evaluate: {querys: q.csv}", "line 5: evaluate: querys: is unknown; did you mean queries?"},
      {"evaluate: {queries: contact.csv}",
       "line 5: evaluate: contact.csv: there is no such file or folder; did you mean "
       "contacts.csv?"},
      {"evaluate: {queries: /dev/null}", "/dev/null: is neither a file nor a folder"},
      {"evaluate:\n  queries: contacts.csv\n  max-distance: nan",
       "line 7: evaluate: --max-distance: is nan; it must be >= 0"},
      {"evaluate:\n  queries: contacts.csv\n  max-distance: .nan",
       "line 7: evaluate: --max-distance"},
      {"evaluate:\n  queries: contacts.csv\n  suggestions: many", "line 7: evaluate: "},
      {"decode: {frames: contacts.csv, rig: scan.ply}", "line 5: decode: pattern is missing"},
      {"decode: {frames: scan.ply, rig: scan.ply, pattern: scan.ply, half-resolution: yes}",
       "line 5: decode: half-resolution: is yes; expected true or false"},
      {"decode: {frames: scan.ply, rig: scan.ply, pattern: scan.ply, resume: true}",
       "line 5: decode: resume: is unknown"},
      {"decode: {frames: ., rig: scan.ply, pattern: scan.ply}",
       "decode: range: is, holds or lies in"},
      {"plan: {spacing: 9, output: acquisition.db}",
       "import: acquisition.db: is, holds or lies in"},
      {"plan: {spacing: 9, output: ..}", "plan: ..: is, holds or lies in"},
      {"export: {}", "line 5: export: "},
      {"export: {obj: true, ply: true}", "line 5: export: "},
  };
  const std::string four = std::string(kQuick).substr(0, std::string(kQuick).find("export"));
  for (const Case& one : cases) {
    write_project(four + one.section + "\n");
    expect_refused(one.words);
  }
  write_project("mesh:\n\trange: scan.ply\n");
  expect_refused("project.yaml: line 2: is not YAML");
  fs::remove(scratch / "project.yaml");
  expect_refused("project.yaml: no such file");
  fs::create_directories(scratch / "project.yaml");
  expect_refused("project.yaml: is a folder");
}

TEST_F(Run, IsDescribedByInfo) {
  const auto info = [&](const char* file) { return run_palpate({"info", scratch / file}).out; };
  EXPECT_THAT(info("project.yaml"),
              HasSubstr("project of 5 steps: mesh, import, fit, play, export"));
  write_project("mesh: {range: scan.ply}\n");
  steps();
  EXPECT_THAT(info("project.run"), HasSubstr("record of palpate run; done: mesh"));
  EXPECT_EQ(run_palpate({"info", scratch / "project.run", "--json"}).status, kDone);
  EXPECT_EQ(run_palpate({"info", scratch / "project.yaml", "--json"}).status, kDone);
}

}  // namespace
}  // namespace palpate::apps
