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

class Merge : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_palpate({"probe", "import", demo("sheet/contacts.csv"), demo("sheet/samples.csv"),
                           "-o", scratch / "acquisition.db"})
                  .status,
              kDone);
    ASSERT_EQ(run_palpate({"fit", scratch / "acquisition.db", demo("sheet/surface.ply"), "-o",
                           scratch / "model", "--accuracy", "5"})
                  .status,
              kDone);
    write_text(scratch / "identity.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    // To the side, and a little lower.
    write_text(scratch / "shift.txt", "1 0 0 3.3\n0 1 0 0\n0 0 1 0.1\n");
  }

  void expect_refused(const std::vector<std::string>& call, int status, const std::string& place) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(scratch / "whole"));
  }

  ScratchFolder scratch;
};

TEST_F(Merge, MakesAModelThatCanBePlayedAndDrawn) {
  const std::string model = scratch / "model";
  const CommandResult merged = run_palpate(
      {"merge", model, model, "--pose", scratch / "identity.txt", "--pose", scratch / "shift.txt",
       "-o", scratch / "whole", "--picture", scratch / "whole.png", "--json"});
  ASSERT_EQ(merged.status, kDone) << merged.err;
  const nlohmann::json figures = nlohmann::json::parse(merged.out);
  const nlohmann::json one = nlohmann::json::parse(run_palpate({"info", model, "--json"}).out);
  EXPECT_EQ(figures["models"], 2);
  EXPECT_EQ(figures["components"], 1);
  EXPECT_GE(figures["contacts"], one["contacts"]);
  EXPECT_EQ(figures["contacts"].get<std::size_t>() + figures["left_out"].size(),
            2 * one["contacts"].get<std::size_t>());
  EXPECT_TRUE(fs::exists(scratch / "whole.png"));
  EXPECT_EQ(run_palpate({"play", scratch / "whole", "--trajectory", demo("trajectory.csv"),
                         "--record", scratch / "trace.csv"})
                .status,
            kDone);
}

TEST_F(Merge, RefusesWhatCannotBeMerged) {
  const std::string model = scratch / "model", whole = scratch / "whole";
  const std::string identity = scratch / "identity.txt";
  expect_refused({"merge", model, scratch / "none", "-o", whole}, kWrongCall, "none");
  expect_refused({"merge", model, model, "--pose", identity, "-o", whole}, kWrongCall, "1 poses");
  expect_refused({"merge", model, "--pose", scratch / "none.txt", "-o", whole}, kWrongCall,
                 "none.txt");
  write_text(scratch / "bad.txt", "1 0 0 0 0 1 0 0 0 0 nan 0");
  expect_refused({"merge", model, "--pose", scratch / "bad.txt", "-o", whole}, kWrongCall,
                 "number 11 is 'nan'");
  write_text(scratch / "bad.txt", "2 0 0 0 0 2 0 0 0 0 2 0");
  expect_refused({"merge", model, "--pose", scratch / "bad.txt", "-o", whole}, kWrongCall,
                 "rotation");
  write_text(scratch / "bad.txt", "1 0 0");
  expect_refused({"merge", model, "--pose", scratch / "bad.txt", "-o", whole}, kWrongCall,
                 "3 numbers");
  expect_refused({"merge", model, model, "-o", model}, kWrongCall, "already used");
  // A flat sheet slides on another.
  expect_refused({"merge", model, model, "--register", "-o", whole}, kWorkFailed, "slides");
}

}  // namespace
}  // namespace palpate::apps
