// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
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

/// A block, probed once on 4 x 4 x 2 cells with exact positions.
class IdentifySolid : public ::testing::Test {
 protected:
  static std::string block(const std::string& shear_modulus) {
    return R"({"type": "finite_elements", "size": [40, 40, 16], "cells": [4, 4, 2],
               "bulk_modulus": 0.6, "shear_modulus": )" +
           shear_modulus + "}";
  }

  static void SetUpTestSuite() {
    probed = std::make_unique<ScratchFolder>();
    const ScratchFolder& at = *probed;
    write_text(at / "truth.json", block("0.06"));
    ASSERT_EQ(
        run_palpate({"probe", "truth", at / "truth.json", "--queries", "0", "-o", at / "truth"})
            .status,
        kDone);
    const CommandResult planned =
        run_palpate({"probe", "plan", at / "truth/surface.ply", "--contacts", "5", "--levels", "2",
                     "--directions", "3", "--max-force", "1.2", "-o", at / "plan.json"});
    ASSERT_EQ(planned.status, kDone) << planned.err;
    const CommandResult measured = run_palpate({"probe", "run", at / "plan.json", "--specimen",
                                                at / "truth.json", "-o", at / "acquisition.db"});
    ASSERT_EQ(measured.status, kDone) << measured.err;
  }
  static void TearDownTestSuite() { probed.reset(); }

  void SetUp() override { write_text(given, block("0.03")); }

  inline static std::unique_ptr<ScratchFolder> probed;
  ScratchFolder scratch;
  const std::string given = scratch / "given.json", acquisition = *probed / "acquisition.db",
                    card = scratch / "identified.json";
};

TEST_F(IdentifySolid, WritesASpecimenFileThatOtherCommandsUse) {
  const std::vector<std::string> call{"identify",    acquisition, "--finite-elements", given,
                                      "--max-pairs", "8",         "--mesh-pairs",      "1",
                                      "-o",          card};
  std::vector<std::string> with_figures = call;
  with_figures.emplace_back("--json");
  const CommandResult result = run_palpate(with_figures);
  ASSERT_EQ(result.status, kDone) << result.err;
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  EXPECT_EQ(figures["model"], "finite-elements");
  EXPECT_EQ(figures["file"], card);
  EXPECT_EQ(figures["mesh_errors"].size(), 2U);
  const nlohmann::json& shear = figures["parameters"][0];
  ASSERT_EQ(shear["status"], "determined");
  // The estimate corrects for a mesh on which the measurements were made: it must not be exact.
  EXPECT_NEAR(shear["value"].get<double>() + figures["mesh_errors"][0].get<double>(), 0.06, 0.004);

  const nlohmann::json written = nlohmann::json::parse(read_text(card));
  EXPECT_EQ(written["shear_modulus"], shear["value"]);
  EXPECT_EQ(written["identified"]["parameters"], figures["parameters"]);
  EXPECT_EQ(
      run_palpate({"bake", card, "--contacts", "3", "--queries", "0", "-o", scratch / "model"})
          .status,
      kDone);
  for (const auto& [simulator, file] :
       {std::pair("calculix", "solid.inp"), {"sofa", "solid.scn"}, {"mujoco", "solid.xml"}}) {
    const CommandResult exported =
        run_palpate({"export", card, "--material", simulator, "-o", scratch / file});
    EXPECT_EQ(exported.status, kDone) << exported.err;
  }
  EXPECT_NE(read_text(scratch / "solid.inp").find("** Press of contact"), std::string::npos);
  // Each simulator has a mesh of its own, in its unit.
  EXPECT_NE(read_text(scratch / "solid.scn.msh"), read_text(scratch / "solid.xml.msh"));
}

TEST_F(IdentifySolid, RefusesWhatCannotBeASolidOfTheMeasurements) {
  const auto refused = [&](const std::vector<std::string>& call) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << call.back();
    return result.err;
  };
  using ::testing::HasSubstr;
  const std::string other = scratch / "other.json";
  write_text(other, R"({"type": "sheet"})");
  EXPECT_THAT(refused({"identify", acquisition, "--finite-elements", other}),
              HasSubstr("expected \"finite_elements\""));
  write_text(other, block("0.03").replace(1, 0, "\"tip_radius\": 3, "));
  EXPECT_THAT(refused({"identify", acquisition, "--finite-elements", other}),
              HasSubstr("tip_radius of 3 mm"));
  EXPECT_THAT(refused({"identify", acquisition, "--finite-elements", scratch / "none.json"}),
              HasSubstr("none.json"));
  EXPECT_THAT(refused({"identify", acquisition, "-o", card}), HasSubstr("--finite-elements"));
  EXPECT_THAT(refused({"identify", acquisition, "--finite-elements", given, "-o", given}),
              HasSubstr("given.json"));
  EXPECT_THAT(refused({"identify", acquisition, "--finite-elements", given, "--model", "strip"}),
              HasSubstr("--model"));
  EXPECT_THAT(refused({"identify", acquisition, "--finite-elements", given, "--max-pairs", "0"}),
              HasSubstr("--max-pairs"));
  EXPECT_THAT(refused({"export", acquisition, "--material", "sofa", "-o", scratch / "a.scn"}),
              HasSubstr("acquisition.db"));
  EXPECT_THAT(refused({"export", given, "--material", "sofa", "-o", scratch / "a.inp"}),
              HasSubstr("must end in .scn"));
  // A mesh that the specimen names is an input, too.
  ASSERT_EQ(run_palpate({"export", given, "--material", "sofa", "-o", scratch / "a.scn"}).status,
            kDone);
  write_text(other, R"({"type": "finite_elements", "shape": "mesh", "file": ")" +
                        (scratch / "a.scn.msh") + R"(", "supports": [{"side": "bottom"}]})");
  EXPECT_THAT(refused({"export", other, "--material", "mujoco", "-o", scratch / "a.scn.msh"}),
              HasSubstr("must end in .xml"));
  EXPECT_THAT(refused({"export", other, "--material", "sofa", "-o", scratch / "a.scn"}),
              HasSubstr("a.scn.msh"));
  EXPECT_THAT(
      refused({"identify", acquisition, "--finite-elements", other, "-o", scratch / "a.scn.msh"}),
      HasSubstr("a.scn.msh"));
  EXPECT_FALSE(std::filesystem::exists(card));
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
