// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Options and files that do not belong together, or make no sense: refused by name, never ignored.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "repository.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

std::string hand() { return repository("meshes/hand.ply").string(); }

struct WrongCall {
  std::vector<std::string> arguments;
  std::string place;  ///< found in the message
};

class WrongOptions : public ::testing::Test {
 protected:
  void expect_refused(const std::vector<WrongCall>& calls) {
    for (const WrongCall& call : calls) {
      const CommandResult result = run_palpate(call.arguments);
      EXPECT_EQ(result.status, kWrongCall) << call.arguments[0] << ' ' << call.place << '\n'
                                           << result.out << result.err;
      EXPECT_NE(result.err.find(call.place), std::string::npos)
          << "no '" << call.place << "' in: " << result.err;
      EXPECT_EQ(result.err.find(".palpate-"), std::string::npos) << result.err;
      EXPECT_TRUE(result.out.empty()) << result.out;
    }
    EXPECT_FALSE(fs::exists(scratch / "out"));
  }

  /// A call with the demonstration's rig and pattern that writes to out.
  std::vector<std::string> simulate(const std::vector<std::string>& more) {
    std::vector<std::string> call = {
        "simulate",           hand(), "--rig",        demo("rig.yaml"), "--pattern",
        demo("pattern.yaml"), "-o",   scratch / "out"};
    call.insert(call.end(), more.begin(), more.end());
    return call;
  }

  std::vector<std::string> with_output(std::vector<std::string> call) {
    call.insert(call.end(), {"-o", scratch / "out"});
    return call;
  }

  std::string named(const std::string& name, const fs::path& original) {
    fs::copy(original, scratch / name);
    return scratch / name;
  }

  ScratchFolder scratch;
};

TEST_F(WrongOptions, APatternForAnotherProjector) {
  ASSERT_EQ(run_palpate({"pattern", "--size", "800", "600", "-o", scratch / "small"}).status, 0);
  const std::string small = scratch / "small/pattern.yaml";
  const std::string frame = demo("frames/duck.png");
  std::string wide = read_text(demo("pattern.yaml"));
  wide.replace(wide.find("990.5"), 5, "1090.5");
  write_text(scratch / "wide.yaml", wide);
  expect_refused({{with_output({"decode", frame, "--rig", demo("rig.yaml"), "--pattern", small}),
                   small + ": projector_size"},
                  {with_output({"decode", frame, "--rig", demo("rig.yaml"), "--pattern",
                                scratch / "wide.yaml"}),
                   "wide.yaml: stripe_edges_px[29]"},
                  {with_output({"calibrate", "chromatic", frame, "--rig", demo("rig.yaml"),
                                "--pattern", small}),
                   small + ": projector_size"},
                  {with_output({"simulate", hand(), "--rig", demo("rig.yaml"), "--pattern", small}),
                   "small/pattern.png: has 800 x 600"}});
}

TEST_F(WrongOptions, DeviationsAreNoDepths) {
  const std::string sigma = named("a_sigma.tiff", demo("truth/duck.tiff"));
  const std::string rig = demo("rig.yaml");
  expect_refused({{{"mesh", sigma, "--rig", rig, "-o", scratch / "out"}, "a_sigma.tiff"},
                  {{"compare", sigma, demo("truth/duck.tiff")}, "a_sigma.tiff"},
                  {{"compare", hand(), sigma, "--rig", rig}, "a_sigma.tiff"}});
}

TEST_F(WrongOptions, OfSimulate) {
  expect_refused({{simulate({"--reflectance", "0.5,0.5"}), "--reflectance"},
                  {simulate({"--shutter", "0.5"}), "--shutter"},
                  {simulate({"--shutter", "nan"}), "--shutter"},
                  {simulate({"--turn", "1e30,0,0"}), "--turn"},
                  {simulate({"--turn", "0,nan,0"}), "--turn"},
                  {simulate({"--exposure-distance", "1e-300"}), "--exposure-distance"},
                  {simulate({"--exposure-distance", "1e300"}), "--exposure-distance"},
                  {simulate({"--distance", "inf"}), "--distance"},
                  {simulate({"--ambient", "nan"}), "--ambient"},
                  {simulate({"--seed", "3000000000"}), "--seed"},
                  {simulate({"--seed", "-1"}), "--seed"}});
}

TEST_F(WrongOptions, AMeshThatIsReadTwiceThroughAPipe) {
  const std::string pipe = scratch / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), S_IRUSR | S_IWUSR), 0);
  expect_refused({{with_output({"simulate", pipe, "--rig", demo("rig.yaml"), "--pattern",
                                demo("pattern.yaml")}),
                   "MESH: " + pipe + " is a pipe; write its content to a file"}});
}

TEST_F(WrongOptions, OfPattern) {
  const std::string rig = demo("rig.yaml");
  expect_refused(
      {{with_output({"pattern", "--period", "1e300"}), "period"},
       {with_output({"pattern", "--min-projector-period", "1e9"}), "--min-projector-period"},
       {with_output({"pattern", "--min-camera-period", "9"}), "--rig"},
       {with_output({"pattern", "--rig", rig, "--period", "769"}), "768"},
       {with_output({"pattern", "--number-of-colors", "1"}), "--number-of-colors: is 1"},
       {with_output({"pattern", "--stripes", "1"}), "--stripes: is 1"},
       {with_output({"pattern", "--bits", "12"}), "--bits is 12"},
       {with_output({"pattern", "--grey-steps", "300"}), "--grey-steps: is 300"},
       {with_output({"pattern", "--rig", rig, "--distances", "900", "500"}),
        "--distances: the nearest object, at 900 mm, is farther away"},
       {with_output({"pattern", "--rig", rig, "--distances", "1e30", "2e30"}), "baseline"}});
}

TEST_F(WrongOptions, OfMesh) {
  const std::string map = demo("truth/duck.tiff");
  const std::string rig = demo("rig.yaml");
  fs::create_directory(scratch.path() / "pictures");
  fs::copy(demo("frames/duck.png"), scratch / "pictures/duck.png");
  fs::create_directory(scratch.path() / "nothing");
  const auto mesh = [&](std::vector<std::string> more) {
    more.insert(more.begin(), "mesh");
    more.insert(more.end(), {"-o", scratch / "x.ply"});
    return more;
  };
  expect_refused(
      {{mesh({map, "--rig", rig, "--scale", "2"}), "--scale"},
       {mesh({map, "--rig", rig, "--unit", "m"}), "--unit"},
       {mesh({map, "--rig", rig, "--intrinsics", "1,1,1,1"}), "--intrinsics"},
       {mesh({hand(), "--scale", "2"}), "--scale"},
       {mesh({hand(), "--smooth", "100000000"}), "--smooth"},
       {mesh({hand(), "--keep-border"}), "--smooth"},
       {mesh({hand(), "--max-depth-step", "0.5"}), "--max-depth-step 0.5 works for range maps"},
       {mesh({hand(), "--tolerance", "1e6"}), "--tolerance"},
       {mesh({hand(), "--picture", scratch / "x.jpg"}), "x.jpg"},
       {mesh({map, "--rig", rig, "--format", "stp"}),
        "--format: is stp; it must be ply, obj or stl"},
       {mesh({scratch / "pictures"}), "a folder of range maps"},
       {mesh({scratch / "nothing"}), "nothing: there is no range map in it"}});
  EXPECT_FALSE(fs::exists(scratch / "x.ply"));
}

TEST_F(WrongOptions, OfCompare) {
  write_text(scratch / "points.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
             "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 1\n");
  expect_refused(
      {{{"compare", hand(), hand(), "--section", scratch / "s.jpg"}, "s.jpg"},
       {{"compare", hand(), hand(), "--section", "s.png", "--section-y", "nan"}, "--section-y"},
       {{"compare", hand(), hand(), "--align", "--method", "icp"},
        "--method: is icp; it must be point_to_triangle, point_to_plane or point_to_point"},
       {{"compare", scratch / "points.ply", hand()}, "points.ply"}});
}

TEST_F(WrongOptions, ANumberThatIsNone) {
  expect_refused({{{"compare", hand(), hand(), "--align", "--search-rotation", "nan"},
                   "--search-rotation: is nan; it must be in [0, 180]"},
                  {{"merge", hand(), hand(), "--register", "--min-overlap", "nan", "-o", "m"},
                   "--min-overlap: is nan; it must be in (0, 1]"},
                  {{"mesh", hand(), "--tolerance", "much", "-o", scratch / "x.ply"},
                   "--tolerance: is much; it must be > 0"},
                  {{"mesh", hand(), "--smooth", "-1", "-o", scratch / "x.ply"},
                   "--smooth: is -1; it must be a whole number in [0, "}});
}

TEST_F(WrongOptions, OfAVideoThatIsNone) {
  write_text(scratch / "a.mp4", std::string(5000, 'x'));
  const CommandResult result =
      run_palpate({"decode", scratch / "a.mp4", "--rig", demo("rig.yaml"), "--pattern",
                   demo("pattern.yaml"), "-o", scratch / "out"});
  EXPECT_EQ(result.status, kWrongCall) << result.err;
  EXPECT_EQ(result.err.find("palpate: "), 0U) << result.err;
  EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << "more than one line: " << result.err;
}

TEST_F(WrongOptions, WhatPalpateWritesIsRecognised) {
  fs::create_directory(scratch.path() / "range");
  fs::copy(demo("truth/duck.tiff"), scratch / "range/000000.tiff");
  fs::copy(demo("truth/duck.tiff"), scratch / "range/000000_sigma.tiff");
  write_text(
      scratch / "range/decode.jsonl",
      R"({"settings": {}, "inputs": []})"
      "\n"
      R"({"number":0,"frame":"a","bytes":1,"modified":1,"pixels":0,"median_depth":null,"ms":1,"evidence":)"
      R"({"edges":0,"off_panel":0,"stripe_edges":0,"agreement":0,"shift":0,)"
      R"("steady_edges":[0,0,0,0,0,0,0,0,0,0,0,0],"displaced_edges":[0,0,0,0,0,0,0,0,0,0,0,0],)"
      R"("rows":0,"trend":{"edges":0,"disparity":0,"disparity_squares":0,"shift":0,"products":0},)"
      R"("neighbours":0,"smoothness":0,"explained":[0,0,0,0,0,0,0,)"
      R"(0],"explained_edges":0,"light":[0,0,0],"lit":0,"hues":0,"trained_hues":0,"steps_)"
      R"(in_pairs":0,"steps_between_pairs":0,"colors_fit_pattern":false,"across":0})"
      "}"
      "\n");
  const auto figures = [](const std::string& path) {
    return nlohmann::json::parse(run_palpate({"info", path, "--json"}).out);
  };
  const nlohmann::json range = figures(scratch / "range");
  EXPECT_EQ(range["range_maps"], 1);
  EXPECT_EQ(range["images"], 0);
  EXPECT_EQ(figures(scratch / "range/decode.jsonl")["frames"], 1);
  const CommandResult moved = run_palpate(simulate({"--ideal"}));
  ASSERT_EQ(moved.status, 0) << moved.err;
  EXPECT_NE(moved.err.find("not completely in view"), std::string::npos) << moved.err;
  const nlohmann::json out = figures(scratch / "out");
  EXPECT_EQ(out["frames"], 1) << out;
}

}  // namespace
}  // namespace palpate::apps
