// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/project_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

class ProjectFile : public ::testing::Test {
 protected:
  Project read(const std::string& text) const {
    write_text(scratch / "project.yaml", text);
    return read_project(scratch / "project.yaml");
  }

  /// Returns the message for a file with this text.
  std::string refusal(const std::string& text) const {
    try {
      (void)read(text);
    } catch (const FileError& error) {
      return error.what();
    }
    return "was read";
  }

  ScratchFolder scratch;
};

TEST_F(ProjectFile, HasSectionsWithEntriesAndTheirLines) {
  const Project project = read(
      "output: results\n"
      "mesh: {range: a.tiff, tolerance: 0.2}\n"
      "decode:\n"
      "  frames: [a.png, b.png]\n"
      "  anchor: [[1, 2, 3], [4, 5, 6]]\n"
      "evaluate:\n");
  EXPECT_EQ(project.output, "results");
  ASSERT_EQ(project.sections.size(), 3U);
  const ProjectSection &mesh = project.sections[0], &decode = project.sections[1];
  using Values = std::vector<std::vector<std::string>>;
  EXPECT_EQ(mesh.name, "mesh");
  EXPECT_EQ(mesh.line, 2);
  ASSERT_EQ(mesh.entries.size(), 2U);
  EXPECT_EQ(mesh.entries[1].name, "tolerance");
  EXPECT_EQ(mesh.entries[1].values, (Values{{"0.2"}}));
  ASSERT_EQ(decode.entries.size(), 2U);
  EXPECT_EQ(decode.entries[0].values, (Values{{"a.png", "b.png"}}));
  EXPECT_EQ(decode.entries[1].line, 5);
  EXPECT_EQ(decode.entries[1].values, (Values{{"1", "2", "3"}, {"4", "5", "6"}}));
  EXPECT_TRUE(project.sections[2].entries.empty());
}

TEST_F(ProjectFile, IsRefusedWithTheLineAndTheReason) {
  struct Case {
    const char *text, *line, *words;
  };
  const Case cases[] = {
      {"mesh:\n\trange: a\n", "line 2", "is not YAML"},
      {"mesh: {range: a\n", "line 2", "is not YAML"},
      {"a\n", "line 1", "expected sections"},
      {"- mesh\n", "line 1", "expected sections"},
      {"fit:\nmesh: [a, b]\n", "line 2", "mesh: expected entries"},
      {"fit:\nmesh: a\n", "line 2", "mesh: expected entries"},
      {"fit:\nmesh:\nfit:\n", "line 3", "'fit' is there twice, also in line 1"},
      {"mesh:\n  range: a\n  range: b\n", "line 3", "'range' is there twice, also in line 2"},
      {"output: a\noutput: b\n", "line 2", "'output' is there twice"},
      {"output: [a]\n", "line 1", "output: has no value, or one with parts"},
      {"mesh: {range: {a: b}}\n", "line 1", "range: has entries of its own"},
      {"mesh: {range: [a, [b]]}\n", "line 1", "range: has no value, or one with parts"},
      {"mesh: {range: [[a], b]}\n", "line 1", "range: is an empty list"},
      {"mesh: {range: []}\n", "line 1", "range: is an empty list"},
      {"mesh: {range: }\n", "line 1", "range: has no value"},
      {"mesh: {range: ''}\n", "line 1", "range: has no value"},
      {"mesh: {range: \"a\\0b\"}\n", "line 1", "a character with the code 0"},
      {"mesh: {[a]: b}\n", "line 1", "a name has parts; expected one word"},
      {"mesh: {range: &a [*a]}\n", "line 1", "nested more than 32 levels"},
      {"mesh:\n---\nfit:\n", "line 2", "a second document begins"},
  };
  for (const Case& one : cases) {
    const std::string said = refusal(one.text);
    EXPECT_NE(said.find(std::string("project.yaml: ") + one.line + ": "), std::string::npos)
        << one.text << said;
    EXPECT_NE(said.find(one.words), std::string::npos) << one.text << said;
  }
  for (const char* empty : {"", "\n", "# nothing\n", "~\n"})
    EXPECT_NE(refusal(empty).find("project.yaml: is empty"), std::string::npos) << empty;
  EXPECT_THROW((void)read_project(scratch / "missing.yaml"), FileError);
  EXPECT_THROW((void)read_project(scratch.path()), FileError);
}

}  // namespace
}  // namespace palpate::apps
