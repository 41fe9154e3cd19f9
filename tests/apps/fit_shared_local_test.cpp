// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate fit --dense-samples`: few samples at most contacts.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "beam_acquisition.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/probing/acquisition_store.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

constexpr int kContacts = 30, kDense = 6;

class FitSharedLocal : public ::testing::Test {
 protected:
  /// Measurements, their surface, and the model of an uninterrupted fit, made once.
  struct Whole {
    ScratchFolder folder;
    std::string store = folder / "a.db", surface = folder / "surface.ply", model = folder / "model";
    CommandResult result;

    Whole() {
      const palpate::support::Beam beam;
      probing::write_acquisition(store,
                                 palpate::support::beam_acquisition(
                                     beam, 5, {.directions = 6, .resolution = 0.4, .seed = 41}));
      geometry::write_mesh(surface, palpate::support::beam_surface(beam));
      result = run_palpate({"fit", store, surface, "-o", model, "--json", "--dense-samples", "40"});
    }
  };
  static const Whole& whole() {
    static const Whole made;
    return made;
  }

  CommandResult fit(std::vector<std::string> more = {}, const CommandOptions& options = {}) const {
    std::vector<std::string> call = {"fit", whole().store,     whole().surface,
                                     "-o",  scratch / "model", "--json"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call, options);
  }

  ScratchFolder scratch;
};

TEST_F(FitSharedLocal, FitsSparseContactsWithWhatDenseOnesHaveInCommonAndTellsSo) {
  const CommandResult& result = whole().result;
  ASSERT_EQ(result.status, kDone) << result.err;
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  const nlohmann::json& sharing = figures["shared_local"];
  EXPECT_EQ(sharing["outcome"], "shared");
  EXPECT_EQ(sharing["dense"], kDense);
  EXPECT_EQ(sharing["sparse"], kContacts - kDense);
  EXPECT_LT(sharing["gain"], -0.3);
  const nlohmann::json model = nlohmann::json::parse(read_text(whole().model + "/field.json"));
  int count = 0;
  for (int i = 0; i < kContacts; ++i) {
    const bool shares = figures["per_contact"][i]["shared_local"];
    EXPECT_EQ(model["contacts"][i]["fit"].value("shared_local", false), shares) << i;
    EXPECT_FALSE(shares && i % 5 == 1) << i;
    count += shares ? 1 : 0;
  }
  EXPECT_GE(count, 22);  // noise may make one keep its own fit
  const std::string made = model["made"]["local part"];
  EXPECT_TRUE(made.starts_with(std::to_string(count) + " share the local part")) << made;
  EXPECT_EQ(run_palpate({"info", whole().model}).status, kDone);
}

TEST_F(FitSharedLocal, SaysWhyEachContactIsFittedOnItsOwn) {
  const CommandResult result = fit({"--dense-samples", "500"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_NE(result.err.find("each contact is fitted on its own"), std::string::npos);
  EXPECT_NE(result.err.find("lower --dense-samples"), std::string::npos);
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  EXPECT_EQ(figures["shared_local"]["outcome"], "too_few_dense");
  EXPECT_TRUE(figures["shared_local"]["gain"].is_null());
  EXPECT_FALSE(figures["per_contact"][0]["shared_local"]);
}

TEST_F(FitSharedLocal, IsResumedWithTheSameSharingOnly) {
  const CommandResult cut =
      fit({"--dense-samples", "40"}, {.interrupt_when_there_is = scratch / "model.fits"});
  ASSERT_EQ(cut.status, kInterrupted) << cut.err;
  const CommandResult other = fit({"--resume"});
  EXPECT_EQ(other.status, kWrongCall);
  EXPECT_NE(other.err.find("another --dense-samples"), std::string::npos) << other.err;
  ASSERT_EQ(fit({"--dense-samples", "40", "--resume"}).status, kDone);
  EXPECT_EQ(read_text(scratch / "model/field.json"), read_text(whole().model + "/field.json"));
}

TEST_F(FitSharedLocal, RefusesWrongNumbers) {
  EXPECT_EQ(fit({"--dense-samples", "3"}).status, kWrongCall);
}

}  // namespace
}  // namespace palpate::apps
