// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate probe run` with arms that have a control loop: virtual, behind a driver, replayed.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/probing/arm_setup.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/contact_plan.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// One contact of a sheet with a few trials, and a quick calibration.
class ProbeArm : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(specimen, R"({"type": "sheet"})");
    setup = {{"calibration", {{"angles", 3}, {"speed", 0.4}, {"settling", 0.3}}}};
    write_text(config, setup.dump());
    plan.normal_forces = {0.6};
    plan.options.directions = 2;
    probing::write_plan(plan_file, plan);
  }

  /// Writes the setup of a device with the pose of the virtual arm.
  void write_setup_with_pose(const json& driver) const {
    const Eigen::Isometry3d pose = probing::mount_over(sheet->surface(), {});
    json with_pose = setup;
    for (int i = 0; i < 3; ++i) {
      with_pose["pose"].push_back(
          {pose.matrix()(i, 0), pose.matrix()(i, 1), pose.matrix()(i, 2), pose.matrix()(i, 3)});
    }
    with_pose["driver"] = driver;
    write_text(config, with_pose.dump());
  }

  std::vector<std::string> call(const std::vector<std::string>& arm, const std::string& output,
                                const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"probe", "run", plan_file, "--json"};
    all.insert(all.end(), arm.begin(), arm.end());
    if (!output.empty()) all.insert(all.end(), {"-o", output});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  json figures(const std::vector<std::string>& arguments) const {
    const CommandResult result = run_palpate(arguments);
    EXPECT_EQ(result.status, kDone) << result.err;
    return json::parse(result.out, nullptr, false);
  }
  std::string refused(const std::vector<std::string>& arguments, int status = kWrongCall) const {
    const CommandResult result = run_palpate(arguments);
    EXPECT_EQ(result.status, status) << result.err;
    return result.err;
  }

  ScratchFolder scratch;
  const std::string specimen = scratch / "sheet.json", plan_file = scratch / "plan.json",
                    config = scratch / "arm.json", store = scratch / "a.db";
  const std::vector<std::string> simulated = {"--arm",  "virtual",      "--specimen",
                                              specimen, "--arm-config", config};
  const std::vector<std::string> device = {"--arm", PALPATE_VIRTUAL_DEVICE, "--arm-config", config};
  const std::shared_ptr<const probing::Specimen> sheet = probing::make_specimen(probing::Sheet{});
  probing::ContactPlan plan = probing::plan_contacts(sheet->surface(), {.contacts = 1});
  json setup;
};

TEST_F(ProbeArm, TheSameArmSimulatedBehindADriverStoppedAndReplayedMeasuresTheSame) {
  const std::string record = scratch / "session.arm";
  const json whole = figures(call(simulated, store, {"--record", record}));
  EXPECT_TRUE(whole["complete"]);
  EXPECT_EQ(whole["samples"], whole["trials"]);
  EXPECT_GE(whole["samples"], 3);

  const json replayed = figures(call({"--replay", record}, scratch / "replayed.db"));
  EXPECT_EQ(replayed["fingerprint"], whole["fingerprint"]);

  write_setup_with_pose({{"seed", "1"}});
  const json driven = figures(call(device, scratch / "driven.db"));
  EXPECT_EQ(driven["fingerprint"], whole["fingerprint"]);

  // A campaign that was stopped before its first trial.
  write_text(config, setup.dump());
  const std::string stop = scratch / "stop";
  const std::string stopped_store = scratch / "stopped.db";
  write_text(stop, "now");
  const std::string stopped =
      refused(call(simulated, stopped_store, {"--stop-file", stop}), kWorkFailed);
  EXPECT_NE(stopped.find("emergency stop"), std::string::npos) << stopped;
  fs::remove(stop);
  const json resumed = figures({"probe", "resume", stopped_store, "--json"});
  EXPECT_EQ(resumed["fingerprint"], whole["fingerprint"]);
}

TEST_F(ProbeArm, AReportWithTheRecordShowsATouchTheCompensationOfGravityAndErrorsOfForces) {
  const std::string record = scratch / "session.arm", surface = scratch / "truth/surface.ply";
  plan.contacts = probing::plan_contacts(sheet->surface(), {.contacts = 3}).contacts;
  probing::write_plan(plan_file, plan);
  const json done = figures(call(simulated, store, {"--record", record}));
  EXPECT_TRUE(done["energy_loops"].is_number());
  (void)figures({"probe", "truth", specimen, "-o", scratch / "truth", "--json"});
  (void)figures({"fit", store, surface, "-o", scratch / "model", "--json"});
  std::vector<std::string> report = {"probe",    "report", store, scratch / "model",
                                     "--record", record,   "-o",  scratch / "report",
                                     "--json"};
  (void)figures(report);
  const std::string page = read_text(scratch / "report/index.html");
  for (const char* picture :
       {"touch.png", "gravity-0.png", "gravity-1.png", "gravity-2.png", "force-errors.png"}) {
    EXPECT_NE(page.find(std::string("<img src=\"") + picture), std::string::npos) << picture;
    EXPECT_GT(fs::file_size(fs::path(scratch / "report") / picture), 10000U) << picture;
  }

  plan.contacts.resize(1);
  probing::write_plan(plan_file, plan);
  (void)figures(call(simulated, scratch / "other.db", {"--record", scratch / "other.arm"}));
  report[5] = scratch / "other.arm";
  EXPECT_NE(refused(report).find("is not the record of this campaign"), std::string::npos);
}

TEST_F(ProbeArm, AFaultOfADeviceEndsTheCampaignWhichGoesOnIfTheObjectHasNotMoved) {
  const std::string first = scratch / "first.arm", second = scratch / "second.arm",
                    moved = scratch / "moved";
  // 95 s of calibration, 40 s of trials.
  write_setup_with_pose(
      {{"fail_at", "122000"}, {"fail_once", scratch / "failed"}, {"moved", moved}});
  const std::string message = refused(call(device, store, {"--record", first}), kWorkFailed);
  EXPECT_NE(message.find("arm does not answer"), std::string::npos) << message;
  EXPECT_NE(message.find("cable pulled"), std::string::npos) << message;
  EXPECT_NE(message.find("continue with: palpate probe resume " + store), std::string::npos);
  const json between = figures({"probe", "status", store, "--json"});
  EXPECT_FALSE(between["complete"]);
  EXPECT_GT(between["trials"], 0);

  write_text(moved, "0.3");  // mm
  const std::string elsewhere = refused({"probe", "resume", store}, kWorkFailed);
  EXPECT_NE(elsewhere.find("the object is not where it was"), std::string::npos) << elsewhere;
  EXPECT_NE(elsewhere.find("give --record"), std::string::npos) << elsewhere;
  const json told = figures({"probe", "status", store, "--json"})["events"].back();
  EXPECT_EQ(told["kind"], "object_moved");
  const std::string by = told["text"];
  ASSERT_EQ(by.find("contact 0: +0."), 0U) << by;
  EXPECT_NEAR(std::stod(by.substr(by.find('+'))), 0.3, 0.06);

  fs::remove(moved);
  EXPECT_NE(refused({"probe", "resume", store, "--record", first}).find("exists already"),
            std::string::npos);
  const json resumed = figures({"probe", "resume", store, "--record", second, "--json"});
  EXPECT_TRUE(resumed["complete"]);
  EXPECT_EQ(resumed["samples"], resumed["trials"]);
  EXPECT_EQ(resumed["references"], 1);

  // Both records one after the other give the same.
  const std::string again = scratch / "again.db";
  (void)refused(call({"--replay", first}, again), kWorkFailed);
  EXPECT_EQ(figures({"probe", "status", again, "--json"})["trials"], between["trials"]);
  EXPECT_EQ(figures({"probe", "resume", again, "--replay", second, "--json"})["fingerprint"],
            resumed["fingerprint"]);
}

TEST_F(ProbeArm, InterruptedByCtrlCItIsResumedAsIfItHadNotBeen) {
  const std::string first = scratch / "first.arm", second = scratch / "second.arm",
                    again = scratch / "again.db";
  const json whole = figures(call(simulated, scratch / "whole.db"));
  const CommandResult stopped =
      run_palpate(call(simulated, store, {"--record", first}), {.interrupt_when_there_is = store});
  ASSERT_EQ(stopped.status, kInterrupted) << stopped.err;
  EXPECT_EQ(figures({"probe", "resume", store, "--record", second, "--json"})["fingerprint"],
            whole["fingerprint"]);
  (void)refused(call({"--replay", first}, again), kWorkFailed);
  EXPECT_EQ(figures({"probe", "resume", again, "--replay", second, "--json"})["fingerprint"],
            whole["fingerprint"]);
}

TEST_F(ProbeArm, ADryRunVisitsContactsWithoutMeasuringAndNamesThoseOutOfReach) {
  plan = probing::plan_contacts(sheet->surface(), {.contacts = 3});
  probing::write_plan(plan_file, plan);
  const json visited = figures(call(simulated, "", {"--dry-run"}));
  EXPECT_EQ(visited["reached"], 3);
  EXPECT_TRUE(visited["unreachable"].empty());

  plan.contacts[1].position.y() += 400;
  probing::write_plan(plan_file, plan);
  const CommandResult far = run_palpate(call(simulated, "", {"--dry-run"}));
  EXPECT_EQ(far.status, kWorkFailed);
  const json missed = json::parse(far.out, nullptr, false);
  EXPECT_EQ(missed["reached"], 2);
  EXPECT_EQ(missed["unreachable"], json::parse(R"([{"contact": 1, "reason": "too_far"}])"));
  // A campaign does not begin.
  EXPECT_NE(refused(call(simulated, store)).find("1 too_far (contacts 1)"), std::string::npos);
  setup["links"] = {{"distance", 100}};
  write_text(config, setup.dump());
  const std::string none = refused(call(simulated, store));
  EXPECT_NE(none.find("3 of 3 contacts: 1 too_far (contacts 1), 2 collides (contacts 0, 2)"),
            std::string::npos)
      << none;
  EXPECT_FALSE(fs::exists(store));
}

TEST_F(ProbeArm, TheLinksOfADeviceStayAwayFromTheSurfaceOfThePlan) {
  (void)figures({"probe", "truth", specimen, "--queries", "1", "-o", scratch / "truth", "--json"});
  const std::string surface = scratch / "truth/surface.ply";
  (void)figures({"probe", "plan", surface, "--contacts", "1", "-o", plan_file, "--json"});
  setup["links"] = {{"distance", 100}};
  write_setup_with_pose(json::object());
  const CommandResult unseen = run_palpate(call(device, "", {"--dry-run"}));
  EXPECT_EQ(unseen.status, kDone) << unseen.err;
  EXPECT_NE(unseen.err.find("give --surface"), std::string::npos) << unseen.err;
  const std::string near = refused(call(device, store, {"--surface", surface}));
  EXPECT_NE(near.find("1 collides (contacts 0)"), std::string::npos) << near;
  write_text(specimen, R"({"type": "beam"})");
  (void)figures({"probe", "truth", specimen, "--queries", "1", "-o", scratch / "beam", "--json"});
  EXPECT_NE(refused(call(device, store, {"--surface", scratch / "beam/surface.ply"}))
                .find("is of another surface"),
            std::string::npos);
}

TEST_F(ProbeArm, RefusesWrongCalls) {
  const auto says = [&](const std::vector<std::string>& arm, const char* words,
                        int status = kWrongCall) {
    const std::string message = refused(call(arm, store), status);
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_FALSE(fs::exists(store));
  };
  says({"--arm", scratch / "missing.so", "--arm-config", config}, "there is no such file");
  says({"--arm", specimen, "--arm-config", config}, "has no 'pose'");
  write_setup_with_pose(json::object());
  says({"--arm", specimen, "--arm-config", config}, "is not a driver that can be loaded");
  says({"--arm", PALPATE_OLD_DEVICE, "--arm-config", config}, "is for version 99");
  write_setup_with_pose({{"mass", "0.1"}});
  says({"--arm", PALPATE_POINT_MASS_DEVICE, "--arm-config", config}, "does not measure its joints",
       kWorkFailed);
  says({"--arm", "virtual"}, "give --specimen");
  says({}, "give --specimen");
  says({"--specimen", specimen, "--arm-config", config}, "has no setup");
  says({"--specimen", specimen, "--stop-file", scratch / "stop"}, "for arms that move");
  says({"--replay", specimen}, "is no record of an arm");
  says({"--replay", specimen, "--specimen", specimen}, "leave out --arm");
  write_text(config, R"({"ramp": -1})");
  says(simulated, "at /ramp: found -1");
  EXPECT_NE(refused(call({"--specimen", specimen}, "")).find("give -o, or --dry-run"),
            std::string::npos);
  EXPECT_NE(refused(call({"--specimen", specimen}, "", {"--dry-run"})).find("does not move"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::apps
