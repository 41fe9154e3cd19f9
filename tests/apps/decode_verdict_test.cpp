// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Behaviour of `palpate decode` with frames that do not fit rig, pattern or colours.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

class DecodeMisfit : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(scratch / "colors.yaml", trained_colors());
    fs::create_directory(scratch / "frames");
    for (const char* name : {"0.png", "1.png"})
      fs::copy(demo("frames/flag_a.png"), scratch / std::string("frames/").append(name));
    std::string shifted = read_text(demo("pattern.yaml"));
    const std::string right = "\nphase: 0.0\n";
    shifted.replace(shifted.find(right), right.size(), "\nphase: 1.5707963\n");
    write_text(scratch / "shifted.yaml", shifted);
  }

  CommandResult decode(const std::string& pattern, std::vector<std::string> more = {}) const {
    std::vector<std::string> call = {
        "decode",   scratch / "frames",      "--rig", demo("rig.yaml"),  "--pattern", pattern,
        "--colors", scratch / "colors.yaml", "-o",    scratch / "range", "--json"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  ScratchFolder scratch;
};

TEST_F(DecodeMisfit, IsRefusedWithItsLikelyCauseAndAcceptedByForce) {
  const CommandResult refused = decode(scratch / "shifted.yaml");
  EXPECT_EQ(refused.status, kWorkFailed);
  EXPECT_NE(refused.err.find("do not fit"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("of a period from where the stripes put it"), std::string::npos)
      << refused.err;
  EXPECT_NE(refused.err.find("--resume --force"), std::string::npos) << refused.err;
  const auto figures = nlohmann::json::parse(refused.out);
  EXPECT_EQ(figures["verdict"], "shifted_sinusoid");
  EXPECT_EQ(figures["per_frame"][1]["verdict"], "shifted_sinusoid");
  EXPECT_TRUE(fs::exists(scratch / "range/000001.tiff"));

  const CommandResult again = decode(scratch / "shifted.yaml", {"--resume"});
  EXPECT_EQ(again.status, kWorkFailed) << "kept frames are judged as well";
  const CommandResult forced = decode(scratch / "shifted.yaml", {"--resume", "--force"});
  EXPECT_EQ(forced.status, kDone) << forced.err;
  EXPECT_NE(forced.err.find("do not fit"), std::string::npos) << "as a warning: " << forced.err;
  EXPECT_EQ(nlohmann::json::parse(forced.out)["kept"], 2);
}

TEST_F(DecodeMisfit, DoesNotReplaceEarlierResultsUnlessForced) {
  const CommandResult right = decode(demo("pattern.yaml"));
  EXPECT_EQ(right.status, kDone) << right.err;
  EXPECT_EQ(nlohmann::json::parse(right.out)["verdict"], "accepted");
  const std::string earlier = read_text(scratch / "range/000000.tiff");

  const CommandResult refused = decode(scratch / "shifted.yaml");
  EXPECT_EQ(refused.status, kWorkFailed);
  EXPECT_NE(refused.err.find("earlier results are unchanged"), std::string::npos) << refused.err;
  EXPECT_EQ(read_text(scratch / "range/000000.tiff"), earlier);

  const CommandResult forced = decode(scratch / "shifted.yaml", {"--resume", "--force"});
  EXPECT_EQ(forced.status, kDone) << forced.err;
  EXPECT_EQ(nlohmann::json::parse(forced.out)["kept"], 2) << "nothing is decoded twice";
  EXPECT_NE(read_text(scratch / "range/000000.tiff"), earlier);
}

}  // namespace
}  // namespace palpate::apps
