// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The output of --json has one documented vocabulary: docs/output.schema.json. `run_palpate`
// compares the figures of every call in these tests with it; here are the commands whose figures no
// other test reads.
#include "output_schema.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "repository.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json schema() { return json::parse(read_text(repository("docs/output.schema.json"))); }

TEST(OutputSchema, HasEveryCommand) {
  std::set<std::string> commands;
  for (const std::string& command : listed_commands(run_palpate({"--help"}).out)) {
    if (command != "calibrate") commands.insert(command);
  }
  for (const std::string& kind : listed_commands(run_palpate({"calibrate", "--help"}).out))
    commands.insert("calibrate " + kind);
  std::set<std::string> described;
  const json document = schema();
  for (const auto& [command, text] : document["definitions"]["commands"].items())
    described.insert(command);
  EXPECT_EQ(described, commands);
}

TEST(OutputSchema, DescribesEveryTerm) {
  const json document = schema();
  EXPECT_GT(document["definitions"]["terms"].size(), 100U);
  for (const auto& [term, text] : document["definitions"]["terms"].items())
    EXPECT_FALSE(text.value("description", "").empty()) << term;
}

TEST(OutputSchema, IsNotThatOfOtherFigures) {
  const std::string right = R"({"contacts": 3, "samples": 5, "output": "a.db"})";
  EXPECT_EQ(differences_from_schema("probe", right), "");
  EXPECT_NE(differences_from_schema("probe", R"({"contacts": 3, "samples": 5})"), "");
  EXPECT_NE(differences_from_schema("probe", R"({"contacts": 3, "samples": "5", "output": "a"})"),
            "");
  EXPECT_NE(differences_from_schema(
                "probe", R"({"contacts": 3, "samples": 5, "output": "a", "seconds": 1})"),
            "");
  EXPECT_NE(differences_from_schema("decoed", right), "");
}

TEST(OutputSchema, OfCommandsWhoseFiguresNoOtherTestReads) {
  const ScratchFolder scratch;
  const std::vector<std::vector<std::string>> calls = {
      {"pattern", "--size", "256", "192", "-o", scratch / "pattern"},
      {"pattern", "--rig", demo("rig.yaml"), "-o", scratch / "for_rig"},
      {"calibrate", "colors", demo("training"), "-o", scratch / "colors.yaml"},
      {"calibrate", "rig", "--projector-size", "320x240", "--draw", scratch / "show"},
      {"probe", "import", demo("sheet/contacts.csv"), demo("sheet/samples.csv"), "-o",
       scratch / "a.db"},
      {"probe", "export", scratch / "a.db", "-o", scratch / "csv"},
      {"fit", scratch / "a.db", demo("sheet/surface.ply"), "--max-bases", "1", "--passive", "local",
       "-o", scratch / "model"},
      {"evaluate", scratch / "model", "--queries", demo("sheet/queries.csv")},
      {"play", scratch / "model", "--trajectory", demo("trajectory.csv"), "--record",
       scratch / "trace.csv"},
      {"info", scratch / "pattern/pattern.yaml"},
      {"info", scratch / "colors.yaml"},
      {"info", scratch / "a.db"},
      {"info", scratch / "model"},
      {"info", scratch / "trace.csv"},
      {"info", demo("rig.yaml")},
      {"info", demo("frames")},
      {"info", demo("frames/flag_a.png")},
      {"info", demo("sheet/surface.ply")},
  };
  for (std::vector<std::string> call : calls) {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, 0) << call[0] << ' ' << call[1] << ": " << result.err;
  }
  EXPECT_EQ(
      run_palpate({"--json", "export", scratch / "model", "--ply", "-o", scratch / "m.ply"}).status,
      0);
}

}  // namespace
}  // namespace palpate::apps
