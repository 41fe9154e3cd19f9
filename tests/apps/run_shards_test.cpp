// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate run --shards`, here and on a Slurm that is played by scripts: the same results as
// without, and only what failed again. tests/cluster has a real Slurm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Words = std::vector<std::string>;
using ::testing::HasSubstr;
using ::testing::Not;

class RunShards : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(scratch / "colors.yaml", trained_colors());
    fs::create_directory(scratch / "frames");
    for (const char* name : {"1.png", "2.png", "3.png"})
      fs::copy(demo("frames/flag_a.png"), scratch / std::string("frames/").append(name));
    for (const char* name : {"rig.yaml", "pattern.yaml"}) fs::copy(demo(name), scratch / name);
    write_project("");
  }

  void write_project(const std::string& more) const {
    write_text(scratch / "project.yaml",
               "decode: {frames: frames, rig: rig.yaml, pattern: pattern.yaml, colors: "
               "colors.yaml, half-resolution: true" +
                   more +
                   "}\n"
                   "mesh:   {range: range, output: meshes}\n");
  }

  CommandResult run(const std::string& output, const Words& more = {},
                    const CommandOptions& options = {}) const {
    Words call = {"run", scratch / "project.yaml", "-o", scratch / output, "--json"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call, options);
  }

  void expect_done(const std::string& output, const Words& more = {}) const {
    const CommandResult result = run(output, more);
    EXPECT_EQ(result.status, kDone) << result.err;
  }

  static void expect_error(const CommandResult& result, int status, const std::string& words) {
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
  }

  /// All results with their content, without journals and the record of the run; in the record of
  /// frames without the times that they took.
  std::map<std::string, std::string> results(const std::string& output) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(scratch / output)) {
      const fs::path name = entry.path().lexically_relative(scratch / output);
      const std::string text = name.string();
      const bool is_other = text.find("/shards/") != std::string::npos ||
                            text.find(".palpate-") != std::string::npos ||
                            text.starts_with("project.");
      if (entry.is_directory() || is_other) continue;
      files[name] = std::regex_replace(read_text(entry.path()), std::regex("\"ms\":[^,]*,"), "");
    }
    return files;
  }

  /// Fingerprints in the record of the content of a step's results, by their names.
  std::map<std::string, json> fingerprints(const std::string& output,
                                           const std::string& step) const {
    std::map<std::string, json> found;
    const json record = json::parse(read_text(scratch / (output + "/project.run")));
    for (const auto& [path, print] : record.at("steps").at(step).at("outputs").items())
      found[fs::path(path).filename()] = print;
    return found;
  }

  /// Makes a run, and then its record as if it had been killed in the step decode.
  void kill_in_decode(const std::string& output) const {
    expect_done(output, {"--shards", "3"});
    std::string record = read_text(scratch / (output + "/project.run"));
    record.replace(record.find("\"done\""), 6, "\"begun\"");
    write_text(scratch / (output + "/project.run"), record);
  }

  /// The entry of a step.
  json status_of(const std::string& output, int step) const {
    return json::parse(run(output, {"--status"}).out).at("steps").at(step);
  }

  ScratchFolder scratch;
};

TEST_F(RunShards, GiveTheSameBytesAndFingerprintsAsARunOfTheWhole) {
  expect_done("whole");
  const auto whole = results("whole");
  ASSERT_TRUE(whole.contains("range/000002.tiff"));
  ASSERT_TRUE(whole.contains("meshes/000002.ply"));
  expect_done("parts", {"--shards", "3"});
  EXPECT_EQ(results("parts"), whole);
  for (const char* step : {"decode", "mesh"})
    EXPECT_EQ(fingerprints("parts", step), fingerprints("whole", step));
  EXPECT_EQ(status_of("parts", 0)["status"], "done");
  EXPECT_TRUE(fs::exists(scratch / "parts/range/shards"));
  const json again = json::parse(run("parts").out);  // the number of shards is no change
  for (const json& step : again["steps"]) EXPECT_EQ(step["status"], "unchanged");
}

TEST_F(RunShards, ThatFailAreNamedAndOnlyTheyAreDoneAgain) {
  kill_in_decode("out");
  const fs::path shards = scratch / "out/range/shards";
  const std::string first = read_text(shards / "0001-of-0003.jsonl");
  const fs::path second = shards / "0002-of-0003.jsonl";
  fs::remove(second);
  fs::remove(scratch / "out/range/000001.tiff");
  CommandOptions full_disk;
  full_disk.max_file_size = 100'000;  // less than a range map, and more than records
  expect_error(run("out", {"--shards", "3"}, full_disk), kWorkFailed,
               "1 of 3 shards failed: 2. The others are kept");
  const json failed = status_of("out", 0);
  EXPECT_EQ(failed["status"], "failed");
  EXPECT_EQ(failed["shards"]["missing"], json({2}));
  EXPECT_NEAR(failed["shards"]["seconds_left"].get<double>() *
                  failed["shards"]["items_per_second"].get<double>(),
              1, 1e-9);
  expect_done("out", {"--shards", "3"});
  EXPECT_TRUE(fs::is_regular_file(second));
  EXPECT_EQ(read_text(shards / "0001-of-0003.jsonl"), first);  // it holds the times
}

TEST_F(RunShards, OfARunThatDidNotFinishKeepTheirNumber) {
  kill_in_decode("out");
  const std::string journal = scratch / "out/range/shards/0001-of-0003.jsonl";
  const std::string first = read_text(journal);
  expect_error(run("out", {"--shards", "2"}), kWrongCall, "Give --shards 3 to go on with them");
  expect_done("out");
  EXPECT_EQ(read_text(journal), first);
  expect_done("whole");
  EXPECT_EQ(results("out"), results("whole"));
}

TEST_F(RunShards, LeaveEarlierResultsUntilAllAreFinished) {
  expect_done("out");
  const auto earlier = results("out");
  write_project(", sigma: true");
  CommandOptions interrupted;
  const std::string unfinished = "out/range/.palpate-unfinished/shards/";
  interrupted.interrupt_when_there_is = scratch / (unfinished + "0001-of-0003.jsonl");
  EXPECT_EQ(run("out", {"--shards", "3"}, interrupted).status, kInterrupted);
  EXPECT_EQ(results("out"), earlier);
  const std::string first = read_text(*interrupted.interrupt_when_there_is);
  EXPECT_EQ(status_of("out", 0)["shards"]["missing"].back(), 3);
  expect_done("out", {"--shards", "3"});
  EXPECT_EQ(read_text(scratch / "out/range/shards/0001-of-0003.jsonl"), first);
  EXPECT_THAT(read_text(scratch / "out/range/shards/call.json"),
              Not(HasSubstr(".palpate-unfinished")));
  EXPECT_FALSE(fs::exists(scratch / "out/range/.palpate-unfinished"));
  expect_done("whole");
  EXPECT_EQ(results("out"), results("whole"));
}

TEST_F(RunShards, OfOtherSettingsAreDropped) {
  CommandOptions interrupted;
  interrupted.interrupt_when_there_is = scratch / "out/range/shards/0001-of-0003.jsonl";
  EXPECT_EQ(run("out", {"--shards", "3"}, interrupted).status, kInterrupted);
  write_project(", sigma: true");
  expect_done("out");
  expect_done("whole", {"--shards", "2"});
  EXPECT_EQ(results("out"), results("whole"));
}

TEST_F(RunShards, AreRefusedWhereNothingCanBeDivided) {
  expect_error(run("out", {"--shards", "0"}), kWrongCall, "--shards");
  write_project(", force: true");
  std::string project = read_text(scratch / "project.yaml");
  write_text(scratch / "project.yaml", project.substr(0, project.find("mesh:")));
  expect_error(run("out", {"--shards", "2"}), kWrongCall, "has no step whose work can be divided");
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

TEST_F(RunShards, AreNotMadeOfASingleFile) {
  write_project("");
  std::string project = read_text(scratch / "project.yaml");
  project.replace(project.find("{range: range, output: meshes"), 29, "{output: one.ply");
  write_text(scratch / "project.yaml", project);
  expect_done("out", {"--shards", "2"});
  EXPECT_TRUE(fs::is_regular_file(scratch / "out/one.ply"));
}

/// Slurm is played by scripts. Its jobs do what they would, one after the other, when they are
/// submitted; or, if there is a file `queue`, only when squeue is called and there is a file
/// `start`.
class RunShardsOnSlurm : public RunShards {
 protected:
  void SetUp() override {
    RunShards::SetUp();
    fs::create_directory(scratch / "bin");
    write_program("do_job", R"sh(#!/usr/bin/env bash
for range in ${2//,/ }; do
  for index in $(seq "${range%-*}" "${range#*-}"); do
    log=$(sed -n 's/^#SBATCH --output="\(.*\)"$/\1/p' job)
    log=${log/'%A'/$1}
    export SLURM_ARRAY_TASK_ID=$index SLURM_RESTART_COUNT=1
    if [[ -e fail && $index == $(<fail) ]]; then
      echo 'CANCELLED DUE TO TIME LIMIT' >"${log/'%a'/$index}"
    else
      bash job >"${log/'%a'/$index}" 2>&1
    fi
  done
done
)sh");
    write_program("sbatch", R"sh(#!/usr/bin/env bash
cd "$SLURM_FOLDER"
[[ $1 == --version ]] && exit
[[ -e refuse ]] && echo 'sbatch: error: invalid partition' >&2 && exit 1
array=${2#--array=}
cat >job
echo "$array" >>submitted
number=$(wc -l <submitted)
if [[ -e queue ]]; then echo "$number $array" >queue; else do_job "$number" "$array"; fi
echo "$number"
)sh");
    write_program("squeue", R"sh(#!/usr/bin/env bash
cd "$SLURM_FOLDER"
[[ $1 == --version || ! -e queue ]] && exit
[[ -e start ]] && do_job $(<queue) && rm queue && exit
read -r number array <queue
echo "$number 1 R"
echo "$number 2 PD"
echo "77 1 R"
)sh");
    const char* const path = std::getenv("PATH");
    on_slurm.environment = {"PATH=" + scratch / "bin" + ":" + (path != nullptr ? path : "/usr/bin"),
                            "SLURM_FOLDER=" + scratch.path().string()};
  }

  void write_program(const std::string& name, const std::string& text) const {
    const std::string file = scratch / ("bin/" + name);
    write_text(file, text);
    fs::permissions(file, fs::perms::owner_all);
  }

  CommandResult submit(const std::string& output) const {
    return run(output, {"--shards", "3", "--executor", "slurm"}, on_slurm);
  }

  /// The arrays that were submitted, a line for each.
  std::string submitted() const { return read_text(scratch / "submitted"); }

  CommandOptions on_slurm;
};

TEST_F(RunShardsOnSlurm, GiveTheSameBytesAsHere) {
  const CommandResult done = submit("out folder");
  EXPECT_EQ(done.status, kDone) << done.err;
  EXPECT_EQ(submitted(), "1-3\n1-3\n");  // decode and mesh
  EXPECT_TRUE(fs::exists(scratch / "out folder/project.logs/mesh/palpate-2-0+3.log"));
  expect_done("whole");
  EXPECT_EQ(results("out folder"), results("whole"));
}

TEST_F(RunShardsOnSlurm, ThatFailAreNamedWithTheirLogsAndOnlyTheyAreSubmittedAgain) {
  write_text(scratch / "fail", "2");
  const CommandResult failed = submit("out");
  expect_error(
      failed, kWorkFailed,
      "1 of 3 shards failed on Slurm: 2. The others are kept; to do only these again, call "
      "palpate run again. Shard 2: CANCELLED DUE TO TIME LIMIT (the end of ");
  EXPECT_THAT(failed.err, HasSubstr("out/project.logs/decode/palpate-1-0+2.log"));
  const json status =
      json::parse(run("out", {"--status"}, on_slurm).out).at("steps").at(0).at("shards");
  EXPECT_EQ(status["missing"], json({2}));
  EXPECT_EQ(status["failed"], json({2}));
  EXPECT_EQ(status["restarts"], 2);
  EXPECT_EQ(status["running"], 0);
  fs::remove(scratch / "fail");
  EXPECT_EQ(submit("out").status, kDone);
  EXPECT_EQ(submitted(), "1-3\n2-2\n1-3\n");
}

TEST_F(RunShardsOnSlurm, GoOnAfterCtrlCAndAreWaitedForAgain) {
  write_text(scratch / "queue", "");
  CommandOptions interrupted = on_slurm;
  interrupted.interrupt_when_there_is = scratch / "submitted";
  const CommandResult stopped = run("out", {"--shards", "3", "--executor", "slurm"}, interrupted);
  expect_error(stopped, kInterrupted, "jobs 1 of Slurm go on; to wait for them again, call");
  const json step = json::parse(run("out", {"--status"}, on_slurm).out).at("steps").at(0);
  EXPECT_EQ(step["status"], "interrupted");
  EXPECT_EQ(step["shards"]["running"], 1);
  EXPECT_EQ(step["shards"]["waiting"], 1);
  expect_error(run("out", {}, on_slurm), kWrongCall, "Wait for them with --executor slurm, or end");
  write_project(", sigma: true");
  expect_error(run("out", {}, on_slurm), kWrongCall, "Wait until they have ended, or end them: sc");
  write_project("");
  write_text(scratch / "start", "");
  EXPECT_EQ(submit("out").status, kDone);
  EXPECT_EQ(submitted(), "1-3\n1-3\n");  // decode once, mesh once
}

TEST_F(RunShardsOnSlurm, AreRefusedWithoutSlurmOrATemplate) {
  CommandOptions options;
  options.environment = {"PATH=" + scratch.path().string()};
  const Words call = {"--shards", "3", "--executor", "slurm"};
  expect_error(run("out", call, options), kWrongCall,
               "--executor slurm: sbatch: cannot be started: No such");
  options = on_slurm;
  options.environment.push_back("PALPATE_TEMPLATE=site.sh");
  expect_error(run("out", call, options), kWrongCall, "PALPATE_TEMPLATE: is site.sh");
  expect_error(run("out", {"--executor", "slurm"}), kWrongCall, "--shards");
  EXPECT_FALSE(fs::exists(scratch / "out"));
  write_text(scratch / "refuse", "");
  expect_error(submit("out"), kWorkFailed,
               "Slurm does not accept the shards: sbatch: error: invalid partition");
}

}  // namespace
}  // namespace palpate::apps
