// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

// A bent square with three contacts, each with a field of one isotropic base.
class Transfer : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(scratch / "model");
    std::string vertices, weighted_vertices, triangles;
    for (int i = 0; i < 81; ++i) {
      const double x = i % 9, y = i / 9;
      const std::string vertex = std::to_string(10 * x) + " " + std::to_string(10 * y) + " " +
                                 std::to_string(x * (8 - x) / 3);
      vertices += vertex + "\n";
      weighted_vertices += vertex + " 0 1 2 0.5 0.25 0.25\n";
      if (i % 9 == 8 || i >= 72) continue;
      triangles += "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " +
                   std::to_string(i + 10) + "\n3 " + std::to_string(i) + " " +
                   std::to_string(i + 10) + " " + std::to_string(i + 9) + "\n";
    }
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 81\nproperty double x\nproperty double y\n"
        "property double z\n";
    const std::string faces =
        "element face 128\nproperty list uchar int vertex_indices\nend_header\n";
    write_text(
        scratch / "model/surface.ply",
        head +
            "property int contact_0\nproperty int contact_1\nproperty int contact_2\n"
            "property double weight_0\nproperty double weight_1\nproperty double weight_2\n" +
            faces + weighted_vertices + triangles);
    write_text(scratch / "other.ply", head + faces + vertices + triangles);
    nlohmann::json contacts = nlohmann::json::array();
    for (int i = 0; i < 3; ++i) {
      contacts.push_back({{"id", i},
                          {"position", {10 + 60 * (i == 1), 10 + 60 * (i == 2), 7 / 3.0}},
                          {"rotation", {0, 1, 0, 0}},
                          {"bases", {{4, 5, 0, 0, 0}}},
                          {"ridges", nlohmann::json::array()},
                          {"friction",
                           {{"coefficient", 0.5},
                            {"lower_bound", 0.4},
                            {"source", "samples"},
                            {"axis", {0, 0, -1}}}},
                          {"fit", {{"samples", 10}, {"rms", 0.01}, {"stop", "accurate"}}}});
    }
    const nlohmann::json document = {
        {"format", "palpate-model"},
        {"version", 1},
        {"units", {{"length", "mm"}, {"force", "N"}}},
        {"surface", "surface.ply"},
        {"interpolation", {{"rule", "forces"}}},
        {"contacts", contacts},
        {"triangles", {{0, 1, 2}}},
        {"registration",
         {{"rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {"translation", {0, 0, 0}}}},
        {"made", nlohmann::json::object()}};
    write_text(scratch / "model/field.json", document.dump());
    put_landmarks("0,0,0,0,0,0\n80,0,0,80,0,0\n80,80,0,80,80,0\n0,80,0,0,80,0\n");
  }

  void put_landmarks(const std::string& lines) const {
    write_text(scratch / "pairs.csv", "sx,sy,sz,tx,ty,tz\n" + lines);
  }

  std::vector<std::string> onto_call() const {
    return {"transfer",    scratch / "model",     "--onto", scratch / "other.ply",
            "--landmarks", scratch / "pairs.csv", "-o",     scratch / "out"};
  }

  void expect_refused(const std::vector<std::string>& call, int status,
                      const std::string& place) const {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(scratch / "out"));
  }

  ScratchFolder scratch;
};

TEST_F(Transfer, ScalesInAllDirectionsAndAlongOne) {
  const CommandResult all = run_palpate({"transfer", scratch / "model", "--scale", "2", "--forces",
                                         "forces", "-o", scratch / "out", "--json"});
  ASSERT_EQ(all.status, kDone) << all.err;
  EXPECT_EQ(nlohmann::json::parse(all.out)["refitted"], 0);
  const CommandResult along =
      run_palpate({"transfer", scratch / "out", "--scale", "0.5", "--axis", "0,1,0", "-o",
                   scratch / "flat", "--json", "--picture", scratch / "flat.png"});
  ASSERT_EQ(along.status, kDone) << along.err;
  const nlohmann::json figures = nlohmann::json::parse(along.out);
  EXPECT_EQ(figures["refitted"], 3);
  EXPECT_GT(figures["refit_largest"], 0);
  EXPECT_TRUE(fs::exists(scratch / "flat.png"));
}

TEST_F(Transfer, CarriesAModelOntoAnotherSurfaceAndDrawsTheMap) {
  std::vector<std::string> call = onto_call();
  for (const std::string& word :
       {std::string("--distortion"), scratch / "map.png", std::string("--distortion-mesh"),
        scratch / "map.ply", std::string("--json")})
    call.push_back(word);
  const CommandResult result = run_palpate(call);
  ASSERT_EQ(result.status, kDone) << result.err;
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  EXPECT_EQ(figures["verdict"], "sensible");
  EXPECT_NEAR(figures["scale"], 1, 1e-6);
  EXPECT_TRUE(fs::exists(scratch / "map.png"));
  EXPECT_NE(read_text(scratch / "map.ply").find("area_distortion"), std::string::npos);
  EXPECT_EQ(run_palpate({"info", scratch / "out"}).status, kDone);
}

TEST_F(Transfer, DrawsAMapThatItRefuses) {
  // Turned over: left is right.
  put_landmarks("0,0,0,80,0,0\n80,0,0,0,0,0\n80,80,0,0,80,0\n0,80,0,80,80,0\n");
  std::vector<std::string> call = onto_call();
  call.push_back("--distortion");
  call.push_back(scratch / "map.png");
  expect_refused(call, kWorkFailed, "folded");
  EXPECT_TRUE(fs::exists(scratch / "map.png"));
}

TEST_F(Transfer, RefusesWrongCallsAndFiles) {
  const std::string model = scratch / "model", out = scratch / "out";
  expect_refused({"transfer", model, "-o", out}, kWrongCall, "nothing to do");
  expect_refused({"transfer", model, "--scale", "nan", "-o", out}, kWrongCall, "--scale");
  expect_refused({"transfer", model, "--scale", "-1", "-o", out}, kWrongCall, "--scale");
  expect_refused({"transfer", model, "--scale", "2", "--axis", "0,0,0", "-o", out}, kWrongCall,
                 "axis");
  expect_refused({"transfer", model, "--scale", "2", "-o", model}, kWrongCall, "already used");
  expect_refused({"transfer", scratch / "none", "--scale", "2", "-o", out}, kWrongCall, "none");
  expect_refused({"transfer", model, "--onto", scratch / "other.ply", "-o", out}, kWrongCall,
                 "--landmarks");
  put_landmarks("0,0,0,0,0,0\n80,0,0,80,0,nan\n80,80,0,80,80,0\n");
  expect_refused(onto_call(), kWrongCall, "line 3, column 'tz'");
  put_landmarks("0,0,0,0,0,0\n40,0,0,40,0,0\n");
  expect_refused(onto_call(), kWrongCall, "at least three");
  put_landmarks("0,0,0,0,0,0\n80,0,0,80,0,0\n80,80,30,80,80,0\n");
  expect_refused(onto_call(), kWrongCall, "landmark 2 of the source is 29");
}

}  // namespace
}  // namespace palpate::apps
