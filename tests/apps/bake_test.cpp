// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate bake`: a model of a simulated object.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Bake : public ::testing::Test {
 protected:
  std::vector<std::string> call(std::vector<std::string> more = {}) const {
    std::vector<std::string> whole = {"bake", specimen, "-o", model};
    whole.insert(whole.end(), more.begin(), more.end());
    return whole;
  }

  static json figures(std::vector<std::string> call) {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << call[0] << ": " << result.err;
    return json::parse(result.out, nullptr, false);
  }

  /// Returns the message for a specimen that the command refuses; it writes nothing.
  std::string refusal(const std::string& text, int status = kWrongCall) const {
    write_text(specimen, text);
    const CommandResult result = run_palpate(call({"--queries", "0"}));
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_FALSE(fs::exists(model));
    return result.err;
  }

  ScratchFolder scratch;
  const std::string specimen = scratch / "specimen.json", model = scratch / "model",
                    store = scratch / "a.db";
};

TEST_F(Bake, MakesAModelOfAClosedFormWhoseErrorIsThatOfEvaluate) {
  write_text(specimen,
             R"({"type": "sheet", "tension": 0.9, "friction": 0.7, "friction_variation": 0})");
  const json baked = figures(call({"--acquisition", store, "--spacing", "20"}));
  EXPECT_GT(baked["contacts"], 15);
  EXPECT_EQ(baked["failed"], json::array());
  EXPECT_EQ(baked["equilibria"], 25 * baked["contacts"].get<int>());
  EXPECT_LT(baked["queries"]["rms"], 0.05);
  ASSERT_EQ(figures({"probe", "truth", specimen, "--queries", "100", "-o",
                     scratch / "truth"})["known_forces"],
            100);
  const json errors = figures({"evaluate", model, "--queries", scratch / "truth/queries.csv"});
  EXPECT_NEAR(errors["queries"]["rms"], baked["queries"]["rms"], 1e-6);
  const json field = json::parse(read_text(model + "/field.json"));
  for (const json& contact : field["contacts"])
    EXPECT_NEAR(contact["friction"]["coefficient"], 0.7, 0.002);
  EXPECT_FALSE(field.contains("probe_radius"));  // a closed form knows no ball

  const json exported = figures({"probe", "export", store, "-o", scratch / "csv"});
  EXPECT_EQ(exported["contacts"], baked["contacts"]);
  EXPECT_EQ(exported["samples"], baked["samples"]);
}

TEST_F(Bake, MakesAModelOfASolidOfFiniteElements) {
  write_text(specimen, R"({"type": "finite_elements", "size": [40, 40, 15], "cells": [4, 4, 2],
                           "shear_modulus": 0.03, "friction": 0.6})");
  const json baked = figures(call({"--spacing", "12", "--directions", "2", "--max-force", "1.2",
                                   "--queries", "20", "--margin", "5"}));
  EXPECT_GE(baked["contacts"], 4);
  EXPECT_EQ(baked["failed"], json::array());
  EXPECT_EQ(baked["queries"]["count"], 20);
  EXPECT_LT(baked["rms"]["median"], 0.02);
  EXPECT_EQ(json::parse(read_text(model + "/field.json")).at("probe_radius"), 5);  // of the tip
  // Cells of 10 mm are coarse for a tip of 5 mm: the model cannot follow the variation of depths
  // within a cell.
  EXPECT_LT(baked["queries"]["rms"], 0.15);
}

TEST_F(Bake, SaysWhatIsWrongWithASpecimen) {
  const std::string begin =
      R"({"type": "finite_elements", "size": [40, 40, 15], "cells": [4, 4, 2])";
  EXPECT_THAT(refusal(begin + R"(, "cell": 3})"),
              AllOf(HasSubstr("specimen.json"), HasSubstr("'cell' is unknown")));
  EXPECT_THAT(refusal(begin + R"(, "supports": []})"), HasSubstr("has no 'supports'"));
  EXPECT_THAT(refusal(R"({"type": "finite_elements", "size": [0.04, 0.04, 0.015]})"),
              HasSubstr("mm"));
  // The right side is pushed through the left one.
  EXPECT_THAT(
      refusal(
          begin + R"(, "supports": [{"side": "left"}, {"side": "right", "move": [-60, 0, 0]}]})",
          kWorkFailed),
      AllOf(HasSubstr("specimen.json"), HasSubstr("no equilibrium after its supports have moved")));
  EXPECT_THAT(refusal(R"({"type": "elastic_body", "size": 8})"), HasSubstr("near_border"));
}

TEST_F(Bake, RefusesWrongCallsBeforeItComputes) {
  write_text(specimen, R"({"type": "sheet"})");
  fs::create_directories(model);
  write_text(model + "/notes.txt", "precious");
  const CommandResult kept = run_palpate(call());
  EXPECT_EQ(kept.status, kWrongCall);
  EXPECT_THAT(kept.err, HasSubstr("notes.txt"));
  const CommandResult into_itself = run_palpate({"bake", specimen, "-o", scratch / ""});
  EXPECT_EQ(into_itself.status, kWrongCall);
  const CommandResult nowhere = run_palpate({"bake", specimen, "-o", specimen + "/model"});
  EXPECT_NE(nowhere.status, kDone);
  EXPECT_THAT(nowhere.err, HasSubstr("specimen.json"));
  // Even the superuser cannot make a folder there. Samples would be written before the model.
  const CommandResult kernel =
      run_palpate({"bake", specimen, "-o", "/proc/model", "--acquisition", store});
  EXPECT_EQ(kernel.status, kWorkFailed);
  EXPECT_THAT(kernel.err, HasSubstr("/proc/model: cannot be written"));
  EXPECT_FALSE(fs::exists(store));
  EXPECT_EQ(run_palpate({"bake", specimen, "-o", scratch / "b", "--max-force", "0"}).status,
            kWrongCall);
  const CommandResult margin =
      run_palpate({"bake", specimen, "-o", scratch / "b", "--margin", "90"});
  EXPECT_EQ(margin.status, kWrongCall);
  EXPECT_THAT(margin.err, HasSubstr("--margin, 90"));
  EXPECT_FALSE(fs::exists(scratch / "b"));
}

TEST_F(Bake, InterruptedKeepsTheEarlierModel) {
  write_text(specimen, R"({"type": "elastic_body", "size": 40})");
  ASSERT_EQ(run_palpate(call({"--queries", "0", "--contacts", "4"})).status, kDone);
  const std::string before = read_text(model + "/field.json");
  write_text(specimen, R"({"type": "sheet"})");
  // The samples are written before the model is fitted.
  const CommandResult result =
      run_palpate(call({"--acquisition", store}), {.interrupt_when_there_is = store});
  EXPECT_EQ(result.status, kInterrupted) << result.err;
  EXPECT_EQ(read_text(model + "/field.json"), before);
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch.path()))
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
}

}  // namespace
}  // namespace palpate::apps
