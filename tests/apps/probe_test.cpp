// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate probe truth | plan | run | resume | status`, and `fit` and `evaluate` of their results.
#include <gtest/gtest.h>
#include <sqlite3.h>

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

class Probe : public ::testing::Test {
 protected:
  static constexpr const char* kSheet = R"({"type": "sheet", "tension": 0.9, "friction": 0.7})";

  void SetUp() override { write_text(specimen, kSheet); }

  static json figures(std::vector<std::string> call) {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << call[1] << ": " << result.err;
    return json::parse(result.out, nullptr, false);
  }

  json plan(std::vector<std::string> more = {}) const {
    std::vector<std::string> call = {"probe", "plan", "--specimen", specimen, "-o", plan_file};
    call.insert(call.end(), more.begin(), more.end());
    return figures(call);
  }

  std::vector<std::string> run_call(const std::string& output) const {
    return {"probe", "run", plan_file, "--specimen", specimen, "-o", output};
  }

  std::string refusal(const std::vector<std::string>& call) const {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << result.err;
    return result.err;
  }

  /// An uninterrupted campaign of twelve contacts, made once; not to be changed.
  struct Campaign {
    ScratchFolder folder;
    std::string specimen = folder / "sheet.json", plan = folder / "plan.json",
                store = folder / "whole.db";
    json done;

    Campaign() {
      write_text(specimen, kSheet);
      (void)figures({"probe", "plan", "--specimen", specimen, "-o", plan, "--contacts", "12"});
      done = figures(run_call(store));
    }
    std::vector<std::string> run_call(const std::string& output) const {
      return {"probe", "run", plan, "--specimen", specimen, "-o", output};
    }
  };
  static const Campaign& campaign() {
    static const Campaign made;
    return made;
  }

  /// Expects that the page shows all existing pictures, and no other.
  static void expect_whole_page(const fs::path& folder) {
    const std::string page = read_text(folder / "index.html");
    int pictures = 0;
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
      if (file.path().extension() != ".png") continue;
      ++pictures;
      EXPECT_GT(file.file_size(), 10000U) << file.path();
      EXPECT_NE(page.find("<img src=\"" + file.path().filename().string() + "\""),
                std::string::npos);
    }
    // Time line, displacements at two forces, stiffness, three contacts, errors.
    EXPECT_EQ(pictures, 8);
    std::size_t shown = 0;
    for (std::size_t at = page.find("<img"); at != std::string::npos;
         at = page.find("<img", at + 1))
      ++shown;
    EXPECT_EQ(shown, 8U);
  }

  ScratchFolder scratch;
  const std::string specimen = scratch / "sheet.json", plan_file = scratch / "plan.json",
                    store = scratch / "a.db";
};

TEST_F(Probe, EndsInAModelWhoseErrorAgainstTheTruthIsKnown) {
  const json truth = figures({"probe", "truth", specimen, "-o", scratch / "truth"});
  EXPECT_EQ(truth["known_forces"], 400);
  const std::string surface = scratch / "truth/surface.ply";
  const json planned = figures({"probe", "plan", surface, "-o", plan_file});
  EXPECT_GT(planned["contacts"], 40);
  EXPECT_LT(planned["cover"], 14);
  EXPECT_GT(planned["excluded"]["near_border"], 100);

  const json done = figures(run_call(store));
  EXPECT_EQ(done["contacts_done"], planned["contacts"]);
  EXPECT_EQ(done["trials_left"], 0);
  EXPECT_TRUE(done["complete"]);
  EXPECT_LT(done["friction_error"], 0.02);
  EXPECT_NEAR(done["hours"].get<double>() * 3600 / done["trials"].get<double>(), 10, 4);

  const json fitted = figures({"fit", store, surface, "-o", scratch / "model"});
  EXPECT_EQ(fitted["contacts"], planned["contacts"]);
  const json errors =
      figures({"evaluate", scratch / "model", "--queries", scratch / "truth/queries.csv"});
  // Bisection gives 0.08 N with 2.5 times the samples (docs/probing.md).
  EXPECT_LT(errors["queries"]["rms"], 0.1);
}

TEST_F(Probe, AReportShowsTheCampaignAndTheErrorOfTheModelAgainstTheTruth) {
  (void)figures({"probe", "truth", specimen, "-o", scratch / "truth"});
  (void)figures({"fit", campaign().store, scratch / "truth/surface.ply", "-o", scratch / "model"});
  const json errors =
      figures({"evaluate", scratch / "model", "--queries", scratch / "truth/queries.csv"});
  const json reported =
      figures({"probe", "report", campaign().store, scratch / "model", "--queries",
               scratch / "truth/queries.csv", "-o", scratch / "report"});
  EXPECT_EQ(reported["queries_rms"], errors["queries"]["rms"]);
  EXPECT_EQ(reported["trials"], campaign().done["trials"]);
  const json& stiffness = reported["stiffness"];
  EXPECT_EQ(stiffness["contacts"], 12);
  EXPECT_TRUE(stiffness["distinct"]);
  EXPECT_GT(stiffness["area"], 0);
  // A stretched sheet is stiffest near its supports, at x = +-50 mm.
  EXPECT_GT(std::abs(stiffness["stiffest"][0].get<double>()), 30);
  expect_whole_page(scratch / "report");
}

TEST_F(Probe, SaysWhereAQuasiStaticModelDoesNotShowWhatWasMeasured) {
  write_text(specimen, R"({"type": "sheet", "retarded": 0.3, "retardation_time": 1.5})");
  plan({"--contacts", "3"});
  const json done = figures(run_call(store));
  // Creep slower than 0.01 mm/s, the last 0.015 mm, is not measured.
  EXPECT_NEAR(done["creep"].get<double>(), 0.3, 0.02);
  EXPECT_TRUE(done["energy_lost"].is_null());  // this arm has no path
  EXPECT_EQ(done["energy_loops"], 0);
  const std::string words = "of the displacement came after the force was constant";
  EXPECT_NE(run_palpate({"probe", "status", store}).out.find(words), std::string::npos);
  (void)figures({"probe", "truth", specimen, "-o", scratch / "truth"});
  const json fitted =
      figures({"fit", store, scratch / "truth/surface.ply", "-o", scratch / "model"});
  ASSERT_EQ(fitted["warnings"].size(), 1) << fitted["warnings"];
  EXPECT_EQ(fitted["warnings"][0]["kind"], "rate_dependent");

  write_text(specimen, R"({"type": "sheet"})");
  const json elastic = figures(run_call(scratch / "elastic.db"));
  EXPECT_EQ(elastic["creep"], 0);
  EXPECT_EQ(run_palpate({"probe", "status", scratch / "elastic.db"}).out.find(words),
            std::string::npos);
}

TEST_F(Probe, InterruptedAndResumedMeasuresTheSame) {
  const json& whole = campaign().done;
  const CommandResult stopped =
      run_palpate(campaign().run_call(store), {.interrupt_when_there_is = store});
  ASSERT_EQ(stopped.status, kInterrupted) << stopped.err;
  EXPECT_NE(stopped.err.find("continue with: palpate probe resume " + store), std::string::npos)
      << stopped.err;
  const json between = figures({"probe", "status", store});
  EXPECT_FALSE(between["complete"]);
  // One before all trials, and one after each 50 samples.
  EXPECT_EQ(whole["references"], 1 + (whole["samples"].get<int>() - 1) / 50);
  EXPECT_EQ(run_palpate({"probe", "status", campaign().store}).out.find("reference force changed"),
            std::string::npos);
  EXPECT_LT(between["trials"], whole["trials"]);
  EXPECT_GT(between["hours_left"], 0);
  json resumed = figures({"probe", "resume", store});
  EXPECT_EQ(resumed["fingerprint"], whole["fingerprint"]);
  resumed["output"] = whole["output"];
  EXPECT_EQ(resumed, whole);
  // Another resume has no trials left.
  EXPECT_EQ(figures({"probe", "resume", store})["fingerprint"], whole["fingerprint"]);
  json status = figures({"probe", "status", store});
  EXPECT_EQ(status["trials"], whole["trials"]);
  EXPECT_TRUE(status["complete"]);
}

// A full disk looks to a process like a limit of the file size.
TEST_F(Probe, AFullDiskEndsACampaignWhichThenGoesOn) {
  plan({"--contacts", "6"});
  const json whole = figures(run_call(scratch / "whole.db"));
  const CommandResult full = run_palpate(run_call(store), {.max_file_size = 300000});
  EXPECT_EQ(full.status, kWorkFailed);
  EXPECT_NE(full.err.find(store + ": disk I/O error"), std::string::npos) << full.err;
  EXPECT_NE(full.err.find("palpate probe resume"), std::string::npos) << full.err;
  const json between = figures({"probe", "status", store});
  EXPECT_GT(between["trials"], 0);
  EXPECT_LT(between["trials"], whole["trials"]);
  EXPECT_EQ(figures({"probe", "resume", store})["fingerprint"], whole["fingerprint"]);
}

TEST_F(Probe, ChoosesForcesByTheStrategyAsked) {
  plan({"--contacts", "2", "--levels", "2"});
  std::vector<std::string> call = run_call(store);
  call.insert(call.end(), {"--strategy", "bisection", "--resolution", "0.4"});
  const json bisected = figures(call);
  // A press at each level; 4 directions halve 3.0 N, and at the upper level 1.5 N, to below 0.4 N.
  EXPECT_EQ(bisected["trials"], 2 * (2 + 4 * 3 + 4 * 2));
  std::vector<std::string> other = run_call(scratch / "b.db");
  other.insert(other.end(), {"--seed", "2"});
  const json pooled = figures(run_call(scratch / "c.db"));
  EXPECT_NE(figures(other)["fingerprint"], pooled["fingerprint"]);
  // Reference probes take time and change nothing else.
  std::vector<std::string> without = run_call(scratch / "d.db");
  without.insert(without.end(), {"--reference-every", "0"});
  const json unreferenced = figures(without);
  EXPECT_EQ(unreferenced["fingerprint"], pooled["fingerprint"]);
  EXPECT_EQ(unreferenced["references"], 0);
  EXPECT_TRUE(unreferenced["drift"].is_null());
  EXPECT_LT(unreferenced["hours"], pooled["hours"]);
}

TEST_F(Probe, AdaptiveCampaignsEndAtTheirLimitAndSayWhatTheyReached) {
  plan({"--contacts", "3"});
  const std::vector<std::string> strategy = {"--strategy", "adaptive"};
  std::vector<std::string> call = run_call(scratch / "whole.db");
  call.insert(call.end(), strategy.begin(), strategy.end());
  EXPECT_NE(refusal(call).find("needs a limit"), std::string::npos);
  call.insert(call.end(), {"--max-samples", "75", "--until", "0.005N"});
  const json whole = figures(call);
  EXPECT_EQ(whole["samples"], 75);
  EXPECT_EQ(whole["stop"], "max_samples");
  EXPECT_GT(whole["stated_at_contacts"], 0);
  const CommandResult status = run_palpate({"probe", "status", scratch / "whole.db"});
  EXPECT_NE(status.out.find("below the noise of the arm's forces"), std::string::npos)
      << status.out;
  std::vector<std::string> again = run_call(store);
  again.insert(again.end(), {"--strategy", "adaptive", "--max-samples", "75", "--until", "0.005"});
  ASSERT_EQ(run_palpate(again, {.interrupt_when_there_is = store}).status, kInterrupted);
  EXPECT_EQ(figures({"probe", "resume", store})["fingerprint"], whole["fingerprint"]);
  std::vector<std::string> other = run_call(scratch / "b.db");
  other.insert(other.end(), {"--until", "0.05"});
  EXPECT_NE(refusal(other).find("--strategy adaptive"), std::string::npos);
}

TEST_F(Probe, ProbesASolidOfFiniteElements) {
  write_text(specimen, R"({"type": "finite_elements", "size": [40, 40, 15], "cells": [4, 4, 2]})");
  EXPECT_EQ(figures({"probe", "truth", specimen, "--queries", "5", "-o",
                     scratch / "truth"})["known_forces"],
            5);
  plan({"--contacts", "1", "--levels", "2", "--highest-force", "0.5", "--directions", "2"});
  const json done = figures(run_call(store));
  EXPECT_EQ(done["contacts_done"], 1);
  EXPECT_GE(done["samples"], 6);
}

TEST_F(Probe, RefusesAStoreWhosePlanIsNotThatOfItsTrials) {
  plan({"--contacts", "2", "--levels", "2"});
  (void)figures(run_call(store));
  plan({"--contacts", "2", "--levels", "3"});
  (void)figures(run_call(scratch / "b.db"));
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(store.c_str(), &raw), SQLITE_OK);
  const std::string take = "ATTACH '" + (scratch / "b.db") +
                           "' AS other; UPDATE run SET value = (SELECT value FROM other.run WHERE "
                           "key = 'plan') WHERE key = 'plan'";
  EXPECT_EQ(sqlite3_exec(raw, take.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(raw);
  for (const char* command : {"status", "resume"}) {
    const std::string message = refusal({"probe", command, store});
    EXPECT_NE(message.find("is not what its plan and its options order"), std::string::npos)
        << message;
  }
}

TEST_F(Probe, PlansOnAGridAndDrawsThePlan) {
  const json planned = plan({"--pattern", "grid", "--picture", scratch / "plan.png"});
  EXPECT_GT(planned["contacts"], 30);
  EXPECT_GT(fs::file_size(scratch / "plan.png"), 10000U);
}

TEST_F(Probe, RefusesWrongCalls) {
  plan({"--contacts", "2", "--levels", "1"});
  EXPECT_NE(refusal({"probe", "plan", "-o", plan_file}).find("either SURFACE or --specimen"),
            std::string::npos);
  EXPECT_NE(refusal({"probe", "plan", "--specimen", specimen, "--tip-radius", "60", "-o",
                     scratch / "b.json"})
                .find("near_border"),
            std::string::npos);
  EXPECT_NE(refusal({"probe", "plan", "--specimen", specimen, "--highest-force", "4", "-o",
                     scratch / "b.json"})
                .find("--max-force is 3"),
            std::string::npos);
  write_text(scratch / "other.json", R"({"type": "beam"})");
  EXPECT_NE(refusal({"probe", "run", plan_file, "--specimen", scratch / "other.json", "-o", store})
                .find("the plan is of another surface"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(store));
  write_text(scratch / "other.json", R"({"type": "beam", "tension": 1})");
  EXPECT_NE(refusal({"probe", "run", plan_file, "--specimen", scratch / "other.json", "-o", store})
                .find("'tension' is unknown; there are type, length"),
            std::string::npos);
  EXPECT_NE(refusal({"probe", "status", specimen}).find("sheet.json"), std::string::npos);
  EXPECT_NE(refusal({"probe", "resume", store}).find("no such file"), std::string::npos);
  ASSERT_EQ(run_palpate(run_call(store)).status, kDone);
  const CommandResult again = run_palpate(run_call(store));
  EXPECT_EQ(again.status, kWorkFailed);
  EXPECT_NE(again.err.find("exists already"), std::string::npos) << again.err;
}

}  // namespace
}  // namespace palpate::apps
