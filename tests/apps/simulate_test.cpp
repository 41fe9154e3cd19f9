// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Simulated frames through the command, and results of them.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

class Simulate : public ::testing::Test {
 protected:
  static std::string hand() { return (demo_data().parent_path() / "meshes/hand.ply").string(); }

  /// A square before the camera, upright at a depth [mm].
  std::string card(const std::string& name, int depth) {
    std::ofstream file(scratch / name);
    file << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
            "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
            "end_header\n";
    for (const char* corner : {"-60 -60 ", "-60 60 ", "60 60 ", "60 -60 "})
      file << corner << depth << '\n';
    file << "3 0 1 2\n3 0 2 3\n";
    return scratch / name;
  }

  /// Simulates into out/.
  CommandResult run(const std::vector<std::string>& meshes, const std::vector<std::string>& more) {
    std::vector<std::string> call = {"simulate"};
    call.insert(call.end(), meshes.begin(), meshes.end());
    call.insert(call.end(),
                {"--rig", demo("rig.yaml"), "--pattern", pattern, "-o", scratch / "out", "--json"});
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  static nlohmann::json figures(const CommandResult& result) {
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }

  ScratchFolder scratch;
  std::string pattern = demo("pattern.yaml");
};

TEST_F(Simulate, ReportsWhatARigWouldMeasureAtSeveralDistances) {
  const nlohmann::json found = figures(run({hand()}, {"--report", "--distance", "550,700"}));
  EXPECT_EQ(found["frames"], 2);
  ASSERT_EQ(found["report"].size(), 2);
  double last = 0;
  for (const nlohmann::json& line : found["report"]) {
    EXPECT_GT(line["distance"], last);
    last = line["distance"];
    EXPECT_GT(line["measurable"], 10000);
    EXPECT_EQ(line["visible"], line["outside"].get<long>() + line["dark"].get<long>() +
                                   line["measurable"].get<long>());
    EXPECT_GT(line["coverage"], 0.5);
    EXPECT_LT(line["relative_median"], 0.0005);
  }
  // The same object covers fewer pixels when it is farther away.
  EXPECT_GT(found["report"][0]["visible"], found["report"][1]["visible"]);
  EXPECT_TRUE(fs::exists(scratch / "out/report/000001.png"));
}

TEST_F(Simulate, MakesFramesThatAreDecodedLikeACameras) {
  figures(run({hand()}, {"--wall", "900", "--seed", "5"}));
  const auto palpate = [](std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    return figures(run_palpate(arguments));
  };
  palpate({"calibrate", "colors", scratch / "out/training/000000", "-o", scratch / "colors.yaml"});
  palpate({"decode", scratch / "out/frames", "--rig", scratch / "out/rig.yaml", "--pattern",
           demo("pattern.yaml"), "--colors", scratch / "colors.yaml", "-o", scratch / "range"});
  const nlohmann::json difference =
      palpate({"compare", scratch / "range/000000.tiff", scratch / "out/truth/000000.tiff"});
  EXPECT_GT(difference["count"], 100000);
  // Noise lets a wall at 900 mm be measured with a deviation of 0.07 mm; half of the errors are
  // below two thirds of that. Twice as much is for the relief of the hand and demosaicing.
  EXPECT_LT(difference["median"], 0.1);
  EXPECT_EQ(palpate({"info", scratch / "out/sensor.yaml"})["kind"], "virtual sensor");
}

TEST_F(Simulate, MakesTheImagesOfStillScenesThatDecodeMultishotReads) {
  ASSERT_EQ(run_palpate(
                {"pattern", "--rig", demo("rig.yaml"), "--multishot", "4", "-o", scratch / "shots"})
                .status,
            0);
  pattern = scratch / "shots/pattern.yaml";
  const nlohmann::json made = figures(run({hand()}, {"--wall", "900", "--distance", "600,700",
                                                     "--decoder-rig", scratch / "shots/rig.yaml"}));
  EXPECT_EQ(made["frames"], 2);
  EXPECT_GT(made["images_of_each"], 4);
  figures(run_palpate({"decode", scratch / "out/frames", "--multishot", "--rig",
                       scratch / "out/rig.yaml", "--pattern", pattern, "-o", scratch / "range",
                       "--json"}));
  for (const std::string scene : {"000000.tiff", "000001.tiff"}) {
    const nlohmann::json difference = figures(run_palpate(
        {"compare", scratch / ("range/" + scene), scratch / ("out/truth/" + scene), "--json"}));
    EXPECT_GT(difference["count"], 200000);
    EXPECT_LT(difference["median"], 0.1);  // as of single images
  }
  EXPECT_NE(run({hand()}, {"--report"}).err.find("--multishot"), std::string::npos);
}

TEST_F(Simulate, MakesAFrameOfEachMeshOfASequence) {
  // A card goes from 700 to 706 mm. The shutter closes half way, in the middle of the exposure it
  // is a quarter of the way; the last mesh does not move.
  EXPECT_EQ(figures(run({card("near.ply", 700), card("far.ply", 706)},
                        {"--shutter", "0.5", "--ideal"}))["frames"],
            2);
  const auto depth = [&](const std::string& name) {
    return figures(run_palpate({"info", scratch / ("out/truth/" + name), "--json"}))["median"]
        .get<double>();
  };
  constexpr double kFloat = 1e-3;  // mm: float holds 700 mm to 6e-5
  EXPECT_NEAR(depth("000000.tiff"), 701.5, kFloat);
  EXPECT_NEAR(depth("000001.tiff"), 706, kFloat);
  EXPECT_EQ(figures(run_palpate({"info", scratch / "out/frames/000001.png", "--json"}))["bits"],
            16);
}

TEST_F(Simulate, RefusesWrongCallsAndWritesNothing) {
  const auto refusal = [&](const std::vector<std::string>& meshes,
                           const std::vector<std::string>& more) {
    const CommandResult result = run(meshes, more);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_FALSE(fs::exists(scratch / "out"));
    return result.err;
  };
  EXPECT_NE(refusal({hand(), hand()}, {"--distance", "500,600"}).find("--distance"),
            std::string::npos);
  EXPECT_NE(refusal({hand()}, {"--texture", demo("pattern.png")}).find("texture coordinates"),
            std::string::npos);
  EXPECT_NE(refusal({hand()}, {"--wall", "300"}).find("sees nothing"), std::string::npos);
  EXPECT_NE(refusal({hand()}, {"--reflectance", "1.5"}).find("reflectance"), std::string::npos);
  EXPECT_NE(refusal({hand()}, {"--distance", "nan"}).find("--distance"), std::string::npos);
}

TEST_F(Simulate, SaysThatThePatternsPictureIsMissing) {
  pattern = scratch / "alone.yaml";
  fs::copy(demo("pattern.yaml"), pattern);
  const CommandResult result = run({hand()}, {});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("alone.png: is missing"), std::string::npos) << result.err;
}

TEST_F(Simulate, KeepsWhatItDidNotWrite) {
  fs::create_directories(scratch / "out");
  std::ofstream(scratch / "out/notes.txt") << "mine";
  const CommandResult result = run({hand()}, {});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("notes.txt"), std::string::npos);
  EXPECT_TRUE(fs::exists(scratch / "out/notes.txt"));
}

}  // namespace
}  // namespace palpate::apps
