// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

class Reduce : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fitted = std::make_unique<ScratchFolder>();
    const ScratchFolder& at = *fitted;
    ASSERT_EQ(run_palpate({"probe", "import", demo("sheet/contacts.csv"), demo("sheet/samples.csv"),
                           "-o", at / "acquisition.db"})
                  .status,
              kDone);
    ASSERT_EQ(
        run_palpate({"mesh", demo("sheet/surface.ply"), "--remesh", "7", "-o", at / "surface.ply"})
            .status,
        kDone);
    ASSERT_EQ(
        run_palpate({"fit", at / "acquisition.db", at / "surface.ply", "-o", at / "model"}).status,
        kDone);
  }
  static void TearDownTestSuite() { fitted.reset(); }

  json figures(std::vector<std::string> call) {
    call.insert(call.begin(), "reduce");
    call.insert(call.end(), {"--strokes", "2000", "--json"});
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << result.err;
    return json::parse(result.out);
  }
  // [N] RMS against known forces, and RMS of each error divided by the stated one.
  std::pair<double, double> errors(const std::string& reduced) {
    const json of = json::parse(
        run_palpate({"evaluate", reduced, "--queries", demo("sheet/queries.csv"), "--json"}).out);
    return {of["queries"]["rms"], of["queries"]["stated"]["ratio"]};
  }

  inline static std::unique_ptr<ScratchFolder> fitted;
  const std::string model = *fitted / "model";
  ScratchFolder scratch;
};

TEST_F(Reduce, MakesASmallerModelThatIsAsGoodAsItStates) {
  const json reduced = figures({model, "--max-error", "0.5", "-o", scratch / "small"});
  EXPECT_LT(reduced["contacts"], reduced["contacts_before"]);
  EXPECT_LE(reduced["difference"]["rms"], reduced["allowed"]);
  EXPECT_LT(reduced["bytes"], reduced["bytes_before"]);
  double bytes = 0;
  for (const auto& file : fs::directory_iterator(scratch / "small"))
    bytes += static_cast<double>(file.file_size());
  EXPECT_NEAR(bytes, reduced["bytes"], 1000);
  const auto [error, ratio] = errors(scratch / "small");
  EXPECT_LT(error, 0.5);  // against the object
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 1.4);
  EXPECT_EQ(run_palpate({"play", scratch / "small", "--trajectory", demo("trajectory.csv")}).status,
            kDone);
}

TEST_F(Reduce, TakesWhatASceneRequires) {
  write_text(scratch / "scene.yaml", "objects:\n  - name: sheet\n    model: " + model + R"(
    require: {force_error: 0.5 N, slip: false, region: {side: [0, 0, 700, -1, 0, 0]}}
)");
  const json reduced = figures({model, "--scene", scratch / "scene.yaml", "-o", scratch / "left"});
  EXPECT_GT(reduced["out_of_reach"].size(), 5U);
  EXPECT_EQ(reduced["contacts"].get<std::size_t>() + reduced["out_of_reach"].size() +
                reduced["predicted"].size(),
            reduced["contacts_before"]);
}

TEST_F(Reduce, WarnsWhereNotEverythingCanHold) {
  const CommandResult result = run_palpate(
      {"reduce", model, "--max-error", "0.01", "--strokes", "100", "-o", scratch / "small"});
  EXPECT_EQ(result.status, kDone);
  EXPECT_THAT(result.err, HasSubstr("states an error of"));
}

TEST_F(Reduce, RefusesACallThatContradictsItself) {
  write_text(scratch / "scene.yaml",
             "objects: [{name: a, model: " + model + ", require: {slip: 1}}]");
  const auto refused = [&](std::vector<std::string> more) {
    std::vector<std::string> call{"reduce", model, "--strokes", "100", "-o", scratch / "small"};
    call.insert(call.end(), more.begin(), more.end());
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall);
    EXPECT_FALSE(fs::exists(scratch / "small"));
    return result.err;
  };
  EXPECT_THAT(refused({"--max-error", "1", "--scene", scratch / "scene.yaml"}),
              HasSubstr("--scene excludes --max-error"));
  EXPECT_THAT(refused({"--object", "a"}), HasSubstr("--scene"));
  EXPECT_THAT(refused({"--scene", scratch / "scene.yaml"}),
              HasSubstr("at /objects/0/require/slip: found 1, expected true or false"));
  EXPECT_THAT(refused({"--max-size", "50"}),
              HasSubstr("--max-size is 50; this model cannot be made smaller than"));
  EXPECT_THAT(refused({"--max-error", "0"}), HasSubstr("--max-error"));
}

}  // namespace
}  // namespace palpate::apps
