// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The commands that calibrate, as a user calls them.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

TEST(Calibrate, ColoursComeWithATableOfWhatIsTakenForWhat) {
  const ScratchFolder scratch;
  const CommandResult result =
      run_palpate({"calibrate", "colors", (demo_data() / "training").string(), "-o",
                   scratch / "colors.yaml", "--picture", scratch / "hues.png", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto figures = nlohmann::json::parse(result.out);
  for (const char* const table : {"overlap_predicted", "overlap_measured"}) {
    ASSERT_EQ(figures[table].size(), 6U);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_GT(figures[table][i][i].get<double>(), 0.95) << table;
  }
  EXPECT_TRUE(fs::exists(scratch / "hues.png"));
}

TEST(Calibrate, ColoursThatCannotBeToldApartAreRefused) {
  const ScratchFolder scratch;
  fs::create_directories(scratch.path() / "training");
  for (const char* const name : {"R", "G", "B"}) {
    const std::string file = std::string(name) + "_flat.png";
    fs::copy(demo_data() / "training" / file, scratch.path() / "training" / file);
  }
  fs::copy(demo_data() / "training/R_flat.png", scratch.path() / "training/O_flat.png");
  write_text(scratch / "colors.yaml", "kept");
  const CommandResult result =
      run_palpate({"calibrate", "colors", scratch / "training", "-o", scratch / "colors.yaml"});
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_NE(result.err.find("training"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("cannot be distinguished"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(scratch / "colors.yaml"), "kept");
}

TEST(Calibrate, CrosstalkIsWrittenToTheRig) {
  const ScratchFolder scratch;
  const std::string training = (demo_data() / "training").string();
  // Each channel under a colour that it does not see: room light, of 2 % of the projector's.
  std::vector<cv::Mat> unlit(3);
  const char* const others[] = {"/R_flat.png", "/B_flat.png", "/G_flat.png"};
  for (int channel = 0; channel < 3; ++channel)
    cv::extractChannel(sensing::read_frame(training + others[channel]),
                       unlit[static_cast<std::size_t>(channel)], channel);
  cv::Mat off;
  cv::merge(unlit, off);
  sensing::write_png(scratch.path() / "off.png", off);
  const CommandResult result = run_palpate(
      {"calibrate", "crosstalk", "--off", scratch / "off.png", "--red", training + "/R_flat.png",
       "--green", training + "/G_flat.png", "--blue", training + "/B_flat.png", "--rig",
       (demo_data() / "rig.yaml").string(), "-o", scratch / "rig.yaml", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto mixing = nlohmann::json::parse(result.out)["mixing"];
  EXPECT_EQ(mixing[1][1], 1.0);
  // The bundled camera separates the colours.
  EXPECT_NEAR(mixing[1][0].get<double>(), 0, 0.001);
  EXPECT_NE(read_text(scratch / "rig.yaml").find("mixing"), std::string::npos);
}

TEST(Calibrate, ARigBeginsWithImagesToProject) {
  const ScratchFolder scratch;
  const CommandResult result =
      run_palpate({"calibrate", "rig", "--draw", scratch / "show", "--projector-size", "320x240"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(fs::exists(scratch / "show/graycode_35.png"));
  EXPECT_FALSE(fs::exists(scratch / "show/graycode_36.png"));
  EXPECT_TRUE(fs::exists(scratch / "show/projected.png"));
}

TEST(Calibrate, ABoardIsDrawnInTrueSize) {
  const ScratchFolder scratch;
  const CommandResult result =
      run_palpate({"calibrate", "rig", "--draw-board", scratch / "board.svg", "--board",
                   "charuco:8x11", "--square", "20", "--marker", "15", "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["print_size"], nlohmann::json({200.0, 260.0}));
  const std::string svg = read_text(scratch / "board.svg");
  EXPECT_NE(svg.find("width=\"200mm\" height=\"260mm\""), std::string::npos) << svg.substr(0, 200);
}

TEST(Calibrate, WrongCallsAreRefused) {
  const ScratchFolder scratch;
  fs::create_directories(scratch.path() / "empty");
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& place) {
    std::vector<std::string> call = {"calibrate"};
    call.insert(call.end(), arguments.begin(), arguments.end());
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << result.out << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos) << result.err;
  };
  const std::string empty = scratch / "empty";
  const std::string out = scratch / "rig.yaml";
  refused({"rig", "--projector-size", "64,48", "--draw", empty}, "'64,48'");
  refused({"rig", empty, "--projector-size", "64x48", "-o", out}, "--board");
  refused({"rig", empty, "--board", "7x9", "--square", "5", "--projector-size", "64x48", "-o", out,
           "--distortion-terms", "3"},
          "--distortion-terms is 3; it must be 0, 2, 4 or 5");
  refused({"rig", empty, "--board", "7x9", "--square", "5", "--projector-size", "64x48", "-o", out},
          "no image");
  const std::string board = scratch / "board.svg";
  const auto no_board = [&](std::vector<std::string> more, const std::string& place) {
    more.insert(more.begin(), {"rig", "--draw-board", board, "--square", "20"});
    refused(more, place);
  };
  no_board({}, "--board");
  no_board({"--board", "charuco:8x11"}, "--marker");
  no_board({"--board", "charuco:8x11", "--marker", "20"}, "--marker");
  no_board({"--board", "charuco:80x80", "--marker", "15"}, "markers");
  no_board({"--board", "8x11", "--marker", "15"}, "chessboard");
  no_board({"--board", "charuco:8", "--marker", "15"}, "'8'");
  const std::string picture = scratch / "board.png";
  refused({"rig", "--draw-board", picture, "--square", "20", "--board", "8x11"}, ".svg");
  EXPECT_FALSE(fs::exists(picture));
  EXPECT_FALSE(fs::exists(board));
  refused({"response", empty, "-o", out}, "grey_000.png");
  refused({"response", empty}, "-o");
  refused({"response"}, "--check");
  fs::copy(demo_data() / "training", scratch.path() / "training");
  const std::string training = scratch / "training";
  refused({"colors", training, "-o", training + "/R_flat.png"}, "is already used");
  refused({"response", "--check", (demo_data() / "frames/plane.png").string(), "--distance", "500"},
          "--rig");
  EXPECT_FALSE(fs::exists(out));
}

TEST(Calibrate, TheSinusoidIsCheckedAndItsWavesPredicted) {
  // The bundled frames have stripes; the sinusoid below them is a clean one.
  const CommandResult result =
      run_palpate({"calibrate", "response", "--check", (demo_data() / "frames/plane.png").string(),
                   "--rig", (demo_data() / "rig.yaml").string(), "--pattern",
                   (demo_data() / "pattern.yaml").string(), "--distance", "700", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto check = nlohmann::json::parse(result.out)["harmonics"]["as it is"];
  EXPECT_EQ(check["along"], "y");
  EXPECT_NEAR(check["period_px"].get<double>(), 7.2, 0.5);
  EXPECT_LT(check["depth_wave"].get<double>(), 0.7);
}

}  // namespace
}  // namespace palpate::apps
