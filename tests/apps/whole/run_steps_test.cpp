// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The table of the steps of a project says the same as the commands.
#include "whole/run_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "whole/all_commands.h"

namespace palpate::apps {
namespace {

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

class RunSteps : public ::testing::Test {
 protected:
  RunSteps() : program("", "palpate") { add_commands(program, settings); }

  Settings settings;
  CLI::App program;
};

/// Options whose values are free text, but no files that are read or written.
const std::set<std::string> kTexts = {
    "arm",    "bayer",        "camera",     "coupling", "crop",        "decimal",
    "device", "fov",          "force-unit", "isolated", "length-unit", "map",
    "object", "pixel-format", "separator",  "set",      "stop-file",   "time-unit",
    "title",  "tool",         "unit",       "viewpoint"};

// A new option that takes a text fails here until the table, or the list above, says what it is:
// a file that a command reads without `palpate run` knowing would leave results as they are when
// it changes.
TEST_F(RunSteps, TellTheFilesAmongTheOptionsOfTheirCommands) {
  for (const ProjectStep& step : project_steps()) {
    const CLI::App& command = *command_of(step.command, program);
    const std::vector<std::string> names = entry_names(command);
    for (const std::string& name : names) {
      if (option_of(command, name)->get_type_name() != "TEXT") continue;  // number, flag or choice
      const int told = static_cast<int>(has(step.inputs, name)) +
                       static_cast<int>(has(step.outputs, name)) +
                       static_cast<int>(kTexts.contains(name));
      EXPECT_EQ(told, 1) << step.name << ": " << name;
    }
    for (const auto& files : {step.inputs, step.outputs})
      for (const std::string& name : files)
        EXPECT_TRUE(has(names, name)) << step.name << " has no " << name;
  }
}

TEST_F(RunSteps, HaveEntriesWithNamesOfTheirOwn) {
  for (const ProjectStep& step : project_steps()) {
    const std::vector<std::string> names = entry_names(*command_of(step.command, program));
    EXPECT_EQ(std::set(names.begin(), names.end()).size(), names.size()) << step.name;
    EXPECT_FALSE(has(names, "resume")) << step.name;
    EXPECT_FALSE(has(names, "help")) << step.name;
  }
}

TEST_F(RunSteps, AreFedWithWhatEarlierStepsHave) {
  std::vector<ProjectStep> earlier;
  for (const ProjectStep& step : project_steps()) {
    for (const Feed& feed : step.feeds) {
      EXPECT_TRUE(has(step.inputs, feed.entry)) << step.name << ": " << feed.entry;
      for (const Feed::Source& source : feed.sources) {
        const auto from = std::ranges::find(earlier, source.step, &ProjectStep::name);
        ASSERT_NE(from, earlier.end()) << step.name << ": " << source.step;
        const bool is_beside =
            std::ranges::find(from->beside, source.entry, &Beside::name) != from->beside.end();
        EXPECT_TRUE(has(from->outputs, source.entry) || has(from->inputs, source.entry) ||
                    is_beside)
            << step.name << ": " << source.step << ": " << source.entry;
      }
    }
    earlier.push_back(step);
  }
}

TEST_F(RunSteps, WriteFoldersBesideTheirResultForOptionsOfTheirCommands) {
  for (const ProjectStep& step : project_steps()) {
    const std::vector<std::string> names = entry_names(*command_of(step.command, program));
    for (const Beside& folder : step.beside) {
      EXPECT_TRUE(has(names, folder.needs)) << step.name << ": " << folder.needs;
      EXPECT_FALSE(step.result_entry.empty()) << step.name;
    }
  }
}

TEST_F(RunSteps, HaveAResultAndAFigure) {
  for (const ProjectStep& step : project_steps()) {
    EXPECT_NE(step.main_figure, nullptr) << step.name;
    if (step.result_entry.empty()) continue;
    EXPECT_TRUE(has(step.outputs, step.result_entry)) << step.name;
    EXPECT_NE(step.result.empty(), step.formats.empty()) << step.name;
    const CLI::App& command = *command_of(step.command, program);
    for (const std::string& format : step.formats)
      EXPECT_EQ(option_of(command, format)->get_items_expected_max(), 0) << format;
  }
}

}  // namespace
}  // namespace palpate::apps
