// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Plans of projects, without doing their steps.
#include "whole/run_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const StepRecord kBefore = {.state = StepState::done,
                            .version = "1.0",
                            .entries = {{"range", {{"a.tiff"}}}, {"tolerance", {{"0.2"}}}},
                            .inputs = {{"a.tiff", "1"}, {"rig.yaml", "2"}},
                            .writes = {"b.ply"},
                            .outputs = {{"b.ply", "3"}}};
const StepRecord kNow = {
    .version = kBefore.version, .entries = kBefore.entries, .inputs = kBefore.inputs, .writes = {}};
const Fingerprints kThere = kBefore.outputs;

TEST(RunChanges, AreNoneIfAllIsAsItWas) {
  EXPECT_THAT(changes_since(kBefore, kNow, kThere), IsEmpty());
}

TEST(RunChanges, NameWhatHasChanged) {
  StepRecord now = kNow;
  now.entries = {{"range", {{"a.tiff"}}}, {"tolerance", {{"0.3"}}}, {"repair", {{"true"}}}};
  now.inputs = {{"a.tiff", "4"}, {"c.tiff", "5"}};
  EXPECT_THAT(changes_since(kBefore, now, kThere),
              ElementsAre("repair is new", "tolerance was 0.2, is 0.3", "a.tiff changed",
                          "c.tiff is new", "rig.yaml is gone"));
  EXPECT_THAT(changes_since(now, kNow, {}),
              ElementsAre("it did not finish", "tolerance was 0.3, is 0.2", "repair is left out",
                          "a.tiff changed", "rig.yaml is new", "c.tiff is gone"));
  now = kNow;
  now.version = "1.1";
  EXPECT_THAT(changes_since(kBefore, now, kThere), ElementsAre("palpate was 1.0, is 1.1"));
  EXPECT_THAT(changes_since(kBefore, kNow, {}), ElementsAre("b.ply is missing"));
  EXPECT_THAT(changes_since(kBefore, kNow, {{"b.ply", "4"}}),
              ElementsAre("b.ply is not as it was written"));
}

TEST(RunChanges, AStepIsResumedOnlyWithTheSameInputsAndEntries) {
  StepRecord begun = kBefore;
  begun.state = StepState::begun;
  begun.outputs = {};
  EXPECT_TRUE(can_be_resumed(begun, kNow));
  EXPECT_FALSE(can_be_resumed(kBefore, kNow));
  StepRecord other = kNow;
  other.inputs["a.tiff"] = "9";
  EXPECT_FALSE(can_be_resumed(begun, other));
  other = kNow;
  other.entries["tolerance"] = {{"9"}};
  EXPECT_FALSE(can_be_resumed(begun, other));
  other = kNow;
  other.version = "9";
  EXPECT_FALSE(can_be_resumed(begun, other));
}

/// The refusal of outputs that are there; empty if they may be replaced.
std::string refusal(const StepRecord* before, const Fingerprints& there) {
  try {
    check_own("mesh", before, there);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(RunChanges, OnlyOutputsOfTheRunMayBeReplaced) {
  EXPECT_EQ(refusal(nullptr, {}), "");
  EXPECT_THAT(refusal(nullptr, kThere), HasSubstr("b.ply: is there, but palpate run did not"));
  EXPECT_EQ(refusal(&kBefore, kThere), "");
  EXPECT_THAT(refusal(&kBefore, {{"b.ply", "4"}}), HasSubstr("b.ply: was changed after"));
  EXPECT_THAT(refusal(&kBefore, {{"c.ply", "3"}}), HasSubstr("c.ply: is there, but"));
  StepRecord begun = kBefore;
  begun.state = StepState::begun;
  begun.writes = {"out"};
  begun.outputs = {};
  EXPECT_EQ(refusal(&begun, {{"out/a.tiff", "1"}, {"out/b/c", "2"}}), "");
  EXPECT_THAT(refusal(&begun, {{"out.ply", "1"}}), HasSubstr("out.ply: is there, but"));
  // After a failure it is known what was written.
  StepRecord failed = begun;
  failed.state = StepState::failed;
  failed.outputs = {{"out/a.tiff", "1"}};
  EXPECT_EQ(refusal(&failed, {{"out/a.tiff", "1"}}), "");
  EXPECT_THAT(refusal(&failed, {{"out/b.tiff", "1"}}), HasSubstr("out/b.tiff: is there, but"));
}

/// Steps in a folder of their own, with files that are written by hand.
class RunPlan : public ::testing::Test {
 protected:
  RunPlan() {
    fs::current_path(scratch.path());
    write_text("in", "1");
  }
  ~RunPlan() override { fs::current_path(home); }

  /// A call of a step that reads and writes these files.
  static StepCall call(const std::string& name, const std::vector<fs::path>& inputs,
                       const std::vector<fs::path>& outputs) {
    const auto steps = project_steps();
    const auto step = std::ranges::find(steps, name, &ProjectStep::name);
    return {.step = &*step, .entries = {{"a", {{"1"}}}}, .inputs = inputs, .outputs = outputs};
  }

  /// As if the step had been done and had written this text.
  void done(const StepCall& step, const std::string& text) {
    StepRecord now = now_of(step);
    for (const fs::path& output : step.outputs) write_text(output, text);
    now.state = StepState::done;
    now.outputs = fingerprints_of(step.outputs);
    record.put(step.step->name, now);
  }

  /// The need and its reason, as "due: in changed".
  std::vector<std::string> needs() const {
    std::vector<std::string> words;
    for (const StepPlan& plan : plan_steps(calls, record)) {
      words.push_back((plan.need == StepNeed::none  ? "none"
                       : plan.need == StepNeed::due ? "due: "
                                                    : "depends: ") +
                      plan.reason);
    }
    return words;
  }

  const fs::path home = fs::current_path();
  ScratchFolder scratch;
  ProjectRecord record{"project.run"};
  const std::vector<StepCall> calls = {call("decode", {"in"}, {"a"}), call("mesh", {"a"}, {"b"}),
                                       call("fit", {"b"}, {"c"})};
};

TEST_F(RunPlan, DoesWhatWasNotDone) {
  EXPECT_THAT(needs(),
              ElementsAre("due: not done before", "due: not done before", "due: not done before"));
}

TEST_F(RunPlan, DoesNothingTwice) {
  for (const StepCall& step : calls) done(step, "made");
  EXPECT_THAT(needs(), ElementsAre("none", "none", "none"));
  record = ProjectRecord("project.run");  // from the disk
  EXPECT_THAT(needs(), ElementsAre("none", "none", "none"));
}

TEST_F(RunPlan, StepsWaitForThoseWhoseOutputsTheyRead) {
  for (const StepCall& step : calls) done(step, "made");
  write_text("in", "2");
  EXPECT_THAT(needs(), ElementsAre("due: in changed", "depends: if decode writes something else",
                                   "depends: if mesh writes something else"));
  done(calls[0], "made");  // the same again
  EXPECT_THAT(needs(), ElementsAre("none", "none", "none"));
  write_text("in", "3");
  done(calls[0], "other");
  EXPECT_THAT(needs(),
              ElementsAre("none", "due: a changed", "depends: if mesh writes something else"));
}

TEST_F(RunPlan, AMissingFileIsMadeAgainBeforeItCountsAsChanged) {
  for (const StepCall& step : calls) done(step, "made");
  fs::remove("a");
  EXPECT_THAT(needs(), ElementsAre("due: a is missing", "depends: if decode writes something else",
                                   "depends: if mesh writes something else"));
}

TEST_F(RunPlan, RefusesBeforeTheFirstStepWhatTheLastWouldReplace) {
  write_text("c", "by hand");
  EXPECT_THROW((void)needs(), InvalidInput);
  fs::remove("c");
  for (const StepCall& step : calls) done(step, "made");
  write_text("c", "by hand");
  EXPECT_THROW((void)needs(), InvalidInput);
}

TEST_F(RunPlan, MeasurementsAreNeverReplaced) {
  const StepCall probe = call("probe", {"in"}, {"a.db"});
  done(probe, "measured");
  EXPECT_EQ(plan_step(probe, record.find("probe"), now_of(probe)).need, StepNeed::none);
  write_text("in", "2");
  try {
    (void)plan_step(probe, record.find("probe"), now_of(probe));
    FAIL() << "was not refused";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.db: holds measurements, which are never replaced, but "
                                        "step 'probe' is due (in changed)"));
  }
  fs::rename("a.db", "kept.db");
  EXPECT_EQ(plan_step(probe, record.find("probe"), now_of(probe)).need, StepNeed::due);
}

TEST_F(RunPlan, FoldersAreTheirFilesWithoutHiddenOnesAndRecords) {
  fs::create_directories("range/.palpate-unfinished");
  fs::create_directories("range/nodes");
  for (const char* file : {"range/0.tiff", "range/nodes/0.ply", "range/.palpate-unfinished/0.tiff",
                           "range/.hidden", "range/decode.jsonl"})
    write_text(file, file);
  std::vector<std::string> files;
  for (const auto& [path, content] : fingerprints_of({"range", "missing"})) files.push_back(path);
  EXPECT_THAT(files, ElementsAre("range/0.tiff", "range/nodes/0.ply"));
}

TEST_F(RunPlan, ARangeMapIsReadWithWhatLiesBesideIt) {
  for (const char* file : {"0.tiff", "0_sigma.tiff", "1_sigma.tiff", "rig.yaml", "notes.txt"})
    write_text(file, file);
  std::vector<std::string> files;
  for (const auto& [path, content] : fingerprints_of({"0.tiff"})) files.push_back(path);
  EXPECT_THAT(files, ElementsAre("0.tiff", "0_sigma.tiff", "rig.yaml"));
}

TEST_F(RunPlan, NamesOfFilesNeedNotBeUtf8) {
  write_text("\xE9", "e");
  const StepCall step = call("decode", {"\xE9"}, {"a"});
  done(step, "made");
  record = ProjectRecord("project.run");
  EXPECT_EQ(plan_step(step, record.find("decode"), now_of(step)).need, StepNeed::none);
  write_text("\xE9", "f");
  EXPECT_EQ(plan_step(step, record.find("decode"), now_of(step)).need, StepNeed::due);
}

TEST_F(RunPlan, ARecordThatIsNoneIsRefused) {
  constexpr const char* kUnknownState =
      R"({"kind": "record of palpate run", "version": 1, "steps": {"fit": {"state": "asleep"}}})";
  for (const char* text :
       {"", "{}", "[1]", "{\"kind\": \"record of palpate run\"",
        R"({"kind": "record of palpate run", "version": 1, "steps": {"a": 1}})",
        R"({"kind": "record of palpate run", "version": 2, "steps": {}})", kUnknownState}) {
    write_text("project.run", text);
    EXPECT_THROW(ProjectRecord("project.run"), FileError) << text;
  }
}

}  // namespace
}  // namespace palpate::apps
