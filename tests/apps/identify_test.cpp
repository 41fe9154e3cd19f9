// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

class Identify : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string sheet = (demo_data() / "sheet").string();
    ASSERT_EQ(run_palpate({"probe", "import", sheet + "/contacts.csv", sheet + "/samples.csv", "-o",
                           acquisition})
                  .status,
              kDone);
  }

  ScratchFolder scratch;
  const std::string acquisition = scratch / "acquisition.db";
};

TEST_F(Identify, TellsTheParametersOfASheetWithTheirErrors) {
  const CommandResult result = run_palpate({"identify", acquisition, "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  EXPECT_EQ(figures["model"], "strip");
  EXPECT_EQ(figures["verdict"], "describes");
  int determined = 0;
  for (const nlohmann::json& parameter : figures["parameters"]) {
    const bool has_numbers =
        parameter["value"].is_number() && parameter["standard_error"].is_number();
    if (parameter["status"] == "determined") {
      ++determined;
      EXPECT_TRUE(has_numbers) << parameter;
    } else {
      EXPECT_FALSE(has_numbers) << parameter;
    }
  }
  EXPECT_GE(determined, 4);
}

TEST_F(Identify, TellsThatASheetIsNoHalfSpace) {
  const CommandResult result =
      run_palpate({"identify", acquisition, "--model", "half-space", "--tool-radius", "3"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_NE(result.out.find("does not describe"), std::string::npos) << result.out;
}

TEST_F(Identify, RefusesWrongCalls) {
  const std::vector<std::vector<std::string>> calls = {
      {"identify", acquisition, "--model", "sponge"},
      {"identify", acquisition, "--model", "half-space"},
      {"identify", acquisition, "--displacement-noise", "0.02"},
      {"identify", scratch / "nowhere.db"}};
  for (const std::vector<std::string>& call : calls) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << call.back();
    EXPECT_FALSE(result.err.empty());
  }
}

}  // namespace
}  // namespace palpate::apps
