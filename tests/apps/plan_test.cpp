// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Core>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Plan : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    measured = std::make_unique<ScratchFolder>();
    const ScratchFolder& at = *measured;
    ASSERT_EQ(run_palpate({"probe", "import", demo("sheet_block/contacts.csv"),
                           demo("sheet_block/samples.csv"), "-o", at / "acquisition.db"})
                  .status,
              kDone);
    ASSERT_EQ(run_palpate({"mesh", demo("sheet_block/surface.ply"), "--remesh", "4", "-o",
                           at / "surface.ply"})
                  .status,
              kDone);
    ASSERT_EQ(
        run_palpate({"fit", at / "acquisition.db", at / "surface.ply", "-o", at / "model"}).status,
        kDone);
  }
  static void TearDownTestSuite() { measured.reset(); }

  void require(const std::string& what, const std::string& more = "") {
    require_of(*measured / "model", what, more);
  }
  void require_of(const std::string& model, const std::string& what, const std::string& more = "") {
    write_text(scratch / "scene.yaml", "objects:\n  - {name: sheet, model: \"" + model +
                                           "\", require: {" + what + "}}\n" + more);
  }
  CommandResult plan(std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"plan", scratch / "scene.yaml"});
    return run_palpate(options);
  }
  json planned(std::vector<std::string> options = {}) {
    options.emplace_back("--json");
    const CommandResult result = plan(std::move(options));
    EXPECT_EQ(result.status, kDone) << result.err;
    return json::parse(result.out)["objects"][0];
  }

  inline static std::unique_ptr<ScratchFolder> measured;
  ScratchFolder scratch;
  // The region in which the model was measured.
  const std::string middle = "region: {box: [-42, -60, 0, 42, 60, 1000]}";
};

// The expected error of the plan is the error that the model of its project states.
TEST_F(Plan, WritesAProjectWhoseModelHasTheExpectedError) {
  require("force_error: 0.06 N, region: {box: [-42, -20, 0, 42, 20, 1000]}");
  const json of =
      planned({"--specimen", demo("probing/sheet_block.json"), "-o", scratch / "project.yaml"});
  EXPECT_EQ(of["limit"], "force_error");
  EXPECT_LE(of["planned"]["error"], 0.06 / 1.1);
  EXPECT_GT(of["planned"]["contacts"], 20);
  const CommandResult run = run_palpate({"run", scratch / "project.yaml", "--json"});
  ASSERT_EQ(run.status, kDone) << run.err;
  const json steps = json::parse(run.out)["steps"];
  ASSERT_EQ(steps.size(), 5U);
  EXPECT_EQ(steps[0]["figures"]["contacts"], of["planned"]["contacts"]);
  const json reduced = steps[3]["figures"];
  const double stated = reduced["stated_before"], expected = of["planned"]["error"];
  EXPECT_GT(stated, 0.75 * expected);
  EXPECT_LT(stated, 1.3 * expected);
  const double bytes = of["planned"]["bytes"];
  EXPECT_NEAR(reduced["bytes_before"], bytes, 0.15 * bytes);
  // Known forces in the region. They differ in size from those of the plan; errors grow with them.
  std::istringstream all(read_text(demo("sheet_block/queries.csv")));
  std::string line, within;
  std::getline(all, line);
  double squares = 0, count = 0;
  for (within = line + "\n"; std::getline(all, line);) {
    std::vector<double> numbers;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
    if (std::abs(numbers.at(1)) > 20) continue;
    within += line + "\n";
    squares += Eigen::Vector3d(numbers[6], numbers[7], numbers.at(8)).squaredNorm();
    ++count;
  }
  write_text(scratch / "queries.csv", within);
  const json truth = json::parse(run_palpate({"evaluate", scratch / "project-results/model",
                                              "--queries", scratch / "queries.csv", "--json"})
                                     .out);
  const double ratio = truth["queries"]["rms"].get<double>() / std::sqrt(squares / count) /
                       (expected / reduced["force_rms"].get<double>());
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 1.4);
}

TEST_F(Plan, TellsThatTheModelMeetsTheRequirement) {
  require("force_error: 0.3 N, " + middle);
  EXPECT_THAT(plan({"-o", scratch / "project.yaml"}).out,
              HasSubstr("meets the requirement already, if it is of this object"));
  EXPECT_THAT(read_text(scratch / "project.yaml"),
              AllOf(HasSubstr("reduce:"), HasSubstr("/model\""), Not(HasSubstr("probe:"))));
}

// Some of the 46 contacts of the model lie outside the region: fewer, placed in it, are better.
TEST_F(Plan, JudgesTheModelByItsErrorNotByTheNumberOfContacts) {
  require("force_error: 0.07 N, region: {box: [-42, -20, 0, 42, 20, 1000]}");
  const json of = planned({"-o", scratch / "project.yaml"});
  EXPECT_LT(of["planned"]["contacts"], 46);
  EXPECT_GT(of["present"]["error"], of["allowed"]);
  EXPECT_FALSE(of["met"]);
  EXPECT_THAT(read_text(scratch / "project.yaml"), HasSubstr("probe:"));
}

TEST_F(Plan, WritesNoProjectIfThereIsNothingToDo) {
  require("force_error: 0.5 N");
  EXPECT_THAT(plan({"-o", scratch / "project.yaml"}).out, HasSubstr("no project is written"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "project.yaml"));
}

TEST_F(Plan, RaisesTheErrorAloudIfTheArmHasTooLittleTime) {
  require("force_error: 0.1 N", "budget: {arm_time: 4 h}\n");
  const json of = planned();
  EXPECT_EQ(of["limit"], "scene_time");
  EXPECT_LE(of["planned"]["arm_hours"], 4);
  EXPECT_GT(of["raised"], 1);
  EXPECT_THAT(plan().err, HasSubstr("times the error that is planned for (0.100 N)"));
}

// The needs of the other object count, whichever object the project is for.
TEST_F(Plan, SharesTheTimeOfTheArmAlsoInAProject) {
  const std::string object = "{name: NAME, model: \"" + (*measured / "model") +
                             "\", require: {force_error: 0.09 N, " + middle + "}}\n";
  const auto named = [&](const std::string& name) {
    std::string text = object;
    return "  - " + text.replace(text.find("NAME"), 4, name);
  };
  write_text(scratch / "scene.yaml",
             "budget: {arm_time: 8 h}\nobjects:\n" + named("left") + named("right"));
  const CommandResult both = plan({"--json"});
  ASSERT_EQ(both.status, kDone) << both.err;
  const json right = json::parse(both.out)["objects"][1];
  EXPECT_LE(right["planned"]["arm_hours"], 4.01);
  ASSERT_EQ(plan({"--object", "right", "-o", scratch / "project.yaml"}).status, kDone);
  EXPECT_THAT(read_text(scratch / "project.yaml"),
              HasSubstr("contacts: " + right["planned"]["contacts"].dump() + " "));
  EXPECT_THAT(plan({"-o", scratch / "project.yaml"}).err,
              HasSubstr("select it with --object: left, right"));
}

TEST_F(Plan, ExplainsFromWhichSourceTheExpectedErrorComes) {
  require("force_error: 0.07 N, " + middle);
  EXPECT_FALSE(planned().contains("budget"));
  const json of = planned({"--explain", "--depth-offset", "0.1"}), budget = of["budget"];
  double squares = 0;
  for (const char* part : {"force_noise", "position_noise", "fit", "across", "spacing", "contrast"})
    squares += std::pow(budget[part].get<double>(), 2);
  const double expected = of["planned"]["error"], offset = budget["surface"]["depth_offset"];
  EXPECT_NEAR(std::sqrt(squares), expected, 1e-9);
  EXPECT_NEAR(budget["stated"], expected, 1e-9);
  EXPECT_NEAR(budget["with_surface"], std::hypot(expected, offset), 1e-9);
  EXPECT_NEAR(offset, 0.1 * budget["per_mm"]["depth_offset"].get<double>(), 1e-9);
  EXPECT_TRUE(budget["surface"]["registration"].is_null());
  EXPECT_THAT(
      plan({"--explain", "--depth-offset", "0.1"}).out,
      AllOf(HasSubstr("distance between contacts"), HasSubstr("offset of the depths, 0.1 mm"),
            HasSubstr("Not included. 0.1 mm would cause: ")));
  EXPECT_EQ(plan({"--depth-offset", "0.1"}).status, kWrongCall);
  EXPECT_THAT(plan({"--explain", "--registration", "-1"}).err,
              HasSubstr("--registration: is -1; it must be >= 0"));
}

TEST_F(Plan, WarnsOfAToolThatIsNotTheProbe) {
  require("force_error: 0.3 N, tool_radius: 4 mm");
  EXPECT_THAT(plan().err, HasSubstr("does not state the radius of its probe"));
  std::filesystem::copy(*measured / "model", scratch / "model");
  json field = json::parse(read_text(scratch / "model/field.json"));
  field["probe_radius"] = 3;
  write_text(scratch / "model/field.json", field.dump());
  require_of(scratch / "model", "force_error: 0.3 N, tool_radius: 4 mm");
  EXPECT_THAT(plan().err, HasSubstr("the force is 15 % higher on a thick solid (Hertz)"));
}

TEST_F(Plan, RefusesWhatCannotBePlanned) {
  require("force_error: 0.1 N");
  EXPECT_THAT(plan({"--object", "liver"}).err,
              HasSubstr("--object: is liver; it must be one of: sheet"));
  EXPECT_EQ(plan({"-o", *measured / "model/surface.ply"}).status, kWrongCall);
  require_of(scratch / "nowhere", "force_error: 0.1 N");
  EXPECT_THAT(plan().err, HasSubstr("A plan needs a first model"));
  require("forces_error: 0.1 N");
  EXPECT_EQ(plan().status, kWrongCall);
}

// Contacts lie only where a scene needs them.
TEST_F(Plan, OfContactsAloneHeedsTheRegionOfAScene) {
  require("force_error: 0.1 N, region: {side: [0, 0, 700, -1, 0, 0]}");
  const auto contacts = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"probe", "plan", *measured / "surface.ply", "-o",
                                     scratch / "plan.json", "--json"});
    const CommandResult result = run_palpate(options);
    EXPECT_EQ(result.status, kDone) << result.err;
    return json::parse(result.out);
  };
  const json all = contacts({}), half = contacts({"--scene", scratch / "scene.yaml"});
  EXPECT_GT(half["excluded"]["not_needed"], 100);
  EXPECT_EQ(all["excluded"]["not_needed"], 0);
  EXPECT_LT(half["contacts"], 0.7 * all["contacts"].get<int>());
  for (const json& contact : json::parse(read_text(scratch / "plan.json"))["contacts"])
    EXPECT_LE(contact["position"][0], 0);
}

}  // namespace
}  // namespace palpate::apps
