// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate play` with a scene file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "../haptics/sheet_model.h"
#include "palpate/haptics/model_io.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// Cells of the last line of a CSV file.
std::vector<std::string> last_cells(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  std::istringstream line(text.substr(text.rfind('\n', end) + 1, end - text.rfind('\n', end)));
  std::vector<std::string> cells;
  for (std::string cell; std::getline(line, cell, ',');) cells.push_back(cell);
  return cells;
}

// A sheet at z = 700 that pushes with 4 d / sqrt(d^2 + 100), here and 1 m beside, where it moves up
// by 8 mm.
class PlayScene : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch = new ScratchFolder;
    haptics::write_model(*scratch / "model", haptics::sheet_model());
    write_text(*scratch / "first.csv", "t,x,y,z\n0,3,4,695\n0.2,3,4,708\n");
    write_text(*scratch / "near.csv", "t,x,y,z\n0,9,4,695\n0.1,9,4,695\n0.3,9,4,708\n");
    write_text(*scratch / "beside.csv", "t,x,y,z\n0,1003,4,697\n");
    write_text(*scratch / "rise.csv",
               "t,x,y,z,qw,qx,qy,qz\n0,1000,0,0,1,0,0,0\n0.3,1000,0,-8,1,0,0,0\n");
    write_text(*scratch / "scene.json", scene().dump());
  }
  static void TearDownTestSuite() {
    delete scratch;
    scratch = nullptr;
  }
  static json scene() {
    return json::parse(R"({"objects": [{"name": "here", "model": "model"},
                                       {"name": "beside", "model": "model", "path": "rise.csv"}],
                           "tools": [{"name": "first", "trajectory": "first.csv"},
                                     {"name": "near", "trajectory": "near.csv"},
                                     {"name": "resting", "trajectory": "beside.csv"}]})");
  }
  static ScratchFolder* scratch;
};
ScratchFolder* PlayScene::scratch = nullptr;

TEST_F(PlayScene, WritesATraceOfEachToolAndOfEachObject) {
  const std::string folder = *scratch / "traces";
  const CommandResult result =
      run_palpate({"play", *scratch / "scene.json", "--record", folder, "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const json figures = json::parse(result.out);
  EXPECT_EQ(figures["steps"], 301);
  ASSERT_EQ(figures["tools"].size(), 3U);
  EXPECT_NEAR(figures["tools"][0]["largest_force"], 4 * 8 / std::hypot(8, 10), 1e-4);
  EXPECT_EQ(figures["tools"][0]["faded"], 0);
  // The second tool touches later, 6 mm beside the first one.
  EXPECT_GT(figures["tools"][1]["faded"], 50);
  EXPECT_NE(result.err.find("tool 'near' touches an object within"), std::string::npos)
      << result.err;
  EXPECT_LT(figures["tools"][1]["largest_force"], figures["tools"][0]["largest_force"]);
  EXPECT_EQ(json::parse(read_text(folder + "/figures.json")), figures);

  const std::vector<std::string> resting = last_cells(read_text(folder + "/tool_resting.csv"));
  ASSERT_EQ(resting.size(), 13U);
  EXPECT_EQ(resting[11], "beside");
  // The sheet that rises pushes to -z.
  EXPECT_NEAR(std::stod(resting[9]), -4 * 5 / std::hypot(5, 10), 1e-4);
  const std::vector<std::string> load = last_cells(read_text(folder + "/object_beside.csv"));
  ASSERT_EQ(load.size(), 7U);
  EXPECT_EQ(std::stod(load[3]), -std::stod(resting[9]));

  // Again, over the record, with other options.
  json other = scene();
  other["near_tools"] = "independent";
  write_text(*scratch / "independent.json", other.dump());
  const CommandResult again =
      run_palpate({"play", *scratch / "independent.json", "--record", folder, "--json"});
  ASSERT_EQ(again.status, kDone) << again.err;
  EXPECT_EQ(json::parse(again.out)["tools"][1]["faded"], 0);
  EXPECT_EQ(json::parse(again.out)["tools"][0], figures["tools"][0]);
}

// The hand follows the trajectory of its tool; the sheet beside moves up by 8 mm without it.
TEST_F(PlayScene, ADeviceMovesAToolAndItsSessionIsReplayed) {
  json of_device = scene();
  of_device["tools"][0].erase("trajectory");
  write_text(*scratch / "device.json", of_device.dump());
  const std::string file = *scratch / "device.json", session = *scratch / "s.bin",
                    folder = *scratch / "device_traces";
  const CommandResult result =
      run_palpate({"play", file, "--device", "hand", "--tool", "near", "--ramp", "0.01",
                   "--session", session, "--record", folder, "--json"});
  ASSERT_EQ(result.status, kWrongCall);
  EXPECT_THAT(result.err, HasSubstr("tool 'first' has no 'trajectory'"));
  const CommandResult played =
      run_palpate({"play", *scratch / "scene.json", "--device", "hand", "--tool", "near", "--ramp",
                   "0.01", "--session", session, "--record", folder, "--json"});
  ASSERT_EQ(played.status, kDone) << played.err;
  const json figures = json::parse(played.out);
  EXPECT_NEAR(figures.at("steps").get<double>(), 301, 1);
  EXPECT_GT(figures.at("stick"), 20);
  // (0, 0, -8 mm) at the end: the resting tool is 5 mm inside.
  const std::vector<std::string> resting = last_cells(read_text(folder + "/tool_resting.csv"));
  EXPECT_NEAR(std::stod(resting.at(9)), -20 / std::sqrt(125.0), 1e-6);
  EXPECT_EQ(resting.at(11), "beside");
  EXPECT_EQ(last_cells(read_text(folder + "/tool_near.csv")).at(11), "here");
  EXPECT_FALSE(read_text(folder + "/object_beside.csv").empty());

  const CommandResult again =
      run_palpate({"play", *scratch / "scene.json", "--replay", session, "--json"});
  ASSERT_EQ(again.status, kDone) << again.err;
  EXPECT_EQ(json::parse(again.out).at("different"), 0);
  const CommandResult other = run_palpate({"play", file, "--replay", session});
  EXPECT_EQ(other.status, kWrongCall);
  const CommandResult model = run_palpate({"play", *scratch / "model", "--replay", session});
  EXPECT_EQ(model.status, kWrongCall);
  EXPECT_THAT(model.err, HasSubstr("is the session of a scene"));
  EXPECT_THAT(run_palpate({"play", file, "--device", "hand", "--tool", "none"}).err,
              HasSubstr("has no tool 'none'; it has first, near, resting"));
  EXPECT_THAT(run_palpate({"play", file, "--device", "hand"}).err,
              HasSubstr("tool 'first' has no trajectory"));
  EXPECT_THAT(run_palpate({"play", file}).err, HasSubstr("tool 'first' has no 'trajectory'"));
}

TEST_F(PlayScene, RefusesWhatDoesNotFit) {
  const auto expect_words = [](const std::vector<std::string>& call, const std::string& words) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << result.out;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  };
  const std::string file = *scratch / "scene.json";
  expect_words({"play", file, "--trajectory", *scratch / "first.csv"},
               "--trajectory: does nothing with a scene file");
  expect_words({"play", file, "--device", "hand", "--exchange", *scratch / "model"},
               "--exchange: does nothing with a device in a scene");
  expect_words({"play", file, "--record", *scratch / "model"}, "model");
  expect_words({"play", *scratch / "missing.json"}, "missing.json");
  json wrong = scene();
  wrong["objects"][0]["model"] = "none";
  write_text(*scratch / "wrong.json", wrong.dump());
  expect_words({"play", *scratch / "wrong.json"}, "none");
  wrong = scene();
  wrong["objects"][1]["pose"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0};
  wrong["objects"][1].erase("path");
  write_text(*scratch / "wrong.json", wrong.dump());
  expect_words({"play", *scratch / "wrong.json"}, "wrong.json: at /objects/1/pose");
}

TEST_F(PlayScene, OneModelWarnsOfAToolOfAnotherRadius) {
  const std::string hertz = "100 % more force (Hertz), here up to 2.499 N of 2.499 N";
  const auto play = [](const std::string& model, const std::vector<std::string>& radii) {
    std::vector<std::string> call{"play", *scratch / model, "--trajectory", *scratch / "first.csv"};
    call.insert(call.end(), radii.begin(), radii.end());
    return run_palpate(call);
  };
  const auto words = [&](const std::string& model, const std::vector<std::string>& radii) {
    const CommandResult result = play(model, radii);
    EXPECT_EQ(result.status, kDone);
    return result.err;
  };
  EXPECT_THAT(words("model", {"--tool-radius", "20", "--probe-radius", "5"}), HasSubstr(hertz));
  EXPECT_EQ(words("model", {"--tool-radius", "20", "--probe-radius", "20"}), "");
  EXPECT_THAT(words("model", {"--tool-radius", "20"}),
              HasSubstr("does not say with which ball it was measured; give --probe-radius"));
  haptics::Model model = haptics::sheet_model();
  model.probe_radius = 5;
  haptics::write_model(*scratch / "known", model);
  EXPECT_THAT(words("known", {"--tool-radius", "20"}), HasSubstr(hertz));
  EXPECT_EQ(words("known", {"--tool-radius", "5"}), "");
  const CommandResult contrary = play("known", {"--tool-radius", "20", "--probe-radius", "3"});
  EXPECT_EQ(contrary.status, kWrongCall);
  EXPECT_THAT(contrary.err, HasSubstr("--probe-radius: is 3 mm; "));
}

}  // namespace
}  // namespace palpate::apps
