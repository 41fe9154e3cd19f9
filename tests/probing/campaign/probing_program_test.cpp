// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/probing_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using Kind = ProbeActionKind;
using ::testing::ElementsAre;

const TrialOrder kOrder{.trial = 5,
                        .contact = {.id = 2, .position = {1, 2, 700}, .normal = {0, 0, -1}},
                        .level = 3,
                        .direction = 1,
                        .normal_force = {0, 0, 1},
                        .tangential_force = {0.5, 0, 0}};

// An arm that answers as a test says, and remembers what it was asked.
class ScriptedArm : public Prober {
 public:
  std::function<ProbeReport(const ProbeAction&)> answer;
  std::vector<ProbeAction> asked;

  ProbeReport perform(const ProbeAction& action) override {
    asked.push_back(action);
    return answer(action);
  }
  [[nodiscard]] std::vector<Kind> kinds() const {
    std::vector<Kind> result;
    for (const ProbeAction& action : asked) result.push_back(action.kind);
    return result;
  }
};

// Springs of 2 mm/N, and a tip that stays where it is or moves by `slid` in the drag.
ProbeReport spring(const ProbeAction& action, double slid) {
  const bool after = action.kind == Kind::drag || action.kind == Kind::release;
  const bool loaded = after || action.kind == Kind::press;
  return {ProbeOutcome::done,
          action.target + (loaded ? Vector3d(2 * action.force) : Vector3d::Zero()) +
              (after ? Vector3d(slid, 0, 0) : Vector3d::Zero()),
          1.5};
}

TEST(ProbingProgram, ATrialIsTheThreeStepsOfTheThesis) {
  ScriptedArm arm{};
  arm.answer = [](const ProbeAction& action) { return spring(action, 0); };
  const TrialResult result = run_trial(arm, kOrder, {});
  EXPECT_THAT(arm.kinds(), ElementsAre(Kind::travel, Kind::touch, Kind::press, Kind::drag,
                                       Kind::release, Kind::lift));
  EXPECT_EQ(arm.asked[0].target, Vector3d(1, 2, 680));
  EXPECT_EQ(arm.asked[1].target, kOrder.contact.position);
  EXPECT_EQ(arm.asked[2].force, Vector3d(0, 0, 1));
  EXPECT_EQ(arm.asked[3].force, Vector3d(0.5, 0, 1));
  EXPECT_EQ(arm.asked[4].force, Vector3d(0, 0, 1));
  EXPECT_EQ(result.outcome, TrialOutcome::held);
  EXPECT_EQ(result.a, Vector3d(1, 2, 702));
  EXPECT_EQ(result.b, Vector3d(2, 2, 702));
  EXPECT_EQ(result.a_again, result.a);
  EXPECT_EQ(result.seconds, 9);
  for (const ProbeAction& action : arm.asked) {
    EXPECT_EQ(action.trial, 5);
    EXPECT_GT(action.time_limit, 0);
  }
}

TEST(ProbingProgram, WithoutATangentialForceItPressesOnly) {
  ScriptedArm arm{};
  arm.answer = [](const ProbeAction& action) { return spring(action, 0); };
  TrialOrder order = kOrder;
  order.direction = -1;
  order.tangential_force.setZero();
  const TrialResult result = run_trial(arm, order, {});
  EXPECT_THAT(arm.kinds(), ElementsAre(Kind::travel, Kind::touch, Kind::press, Kind::lift));
  EXPECT_EQ(result.outcome, TrialOutcome::held);
  EXPECT_EQ(result.b, result.a);
}

// Of the drag of 1 mm, 0.17 mm may stay as microslip. Beyond it, s_x = 0.022 mm and s_f c = 0.01 N
// * 2 mm/N make the threshold sqrt(16.27 * 2) * 0.0297 = 0.170 mm.
TEST(ProbingProgram, ASampleIsMeasuredInItsLastRestAlone) {
  ScriptedArm arm{};
  arm.answer = [](const ProbeAction& action) {
    ProbeReport report = spring(action, 0);
    report.range_map = action.measures_sample ? "range/000005.tiff" : "of another rest";
    return report;
  };
  const auto measured_in = [&] {
    std::vector<Kind> kinds;
    for (const ProbeAction& action : arm.asked)
      if (action.measures_sample) kinds.push_back(action.kind);
    return kinds;
  };
  const TrialResult dragged = run_trial(arm, kOrder, {});
  EXPECT_THAT(measured_in(), ElementsAre(Kind::drag));
  EXPECT_EQ(sample_of(kOrder, dragged, 0)->range_map, "range/000005.tiff");
  arm.asked.clear();
  TrialOrder pressed = kOrder;
  pressed.direction = -1;
  const TrialResult result = run_trial(arm, pressed, {});
  EXPECT_THAT(measured_in(), ElementsAre(Kind::press));
  EXPECT_EQ(result.range_map, "range/000005.tiff");
  arm.answer = [](const ProbeAction& action) {
    ProbeReport report = spring(action, 0);
    report.no_range_map = "dark";
    return report;
  };
  const TrialResult unseen = run_trial(arm, kOrder, {});
  EXPECT_EQ(unseen.no_range_map, "dark");
  EXPECT_FALSE(sample_of(kOrder, unseen, 0)->range_map.has_value());
}

TEST(ProbingProgram, ATipThatDoesNotComeBackSlipped) {
  for (const auto& [slid, outcome] :
       {std::pair(0.33, TrialOutcome::held), std::pair(0.35, TrialOutcome::slipped)}) {
    ScriptedArm arm{};
    arm.answer = [far = slid](const ProbeAction& action) {
      return spring(action, action.kind == Kind::release ? far : 0);
    };
    EXPECT_EQ(run_trial(arm, kOrder, {}).outcome, outcome) << slid;
  }
}

TEST(ProbingProgram, EveryStageCanFailAndIsFollowedByALift) {
  struct Case {
    Kind kind;
    ProbeOutcome said;
    TrialOutcome outcome;
    bool is_sample;
  };
  for (const Case& each :
       {Case{Kind::travel, ProbeOutcome::timed_out, TrialOutcome::timed_out, false},
        Case{Kind::touch, ProbeOutcome::no_contact, TrialOutcome::no_contact, false},
        Case{Kind::press, ProbeOutcome::fell_off, TrialOutcome::fell_off, false},
        Case{Kind::press, ProbeOutcome::unsettled, TrialOutcome::unsettled, false},
        Case{Kind::drag, ProbeOutcome::fell_off, TrialOutcome::fell_off, true},
        Case{Kind::drag, ProbeOutcome::unsettled, TrialOutcome::unsettled, false},
        Case{Kind::release, ProbeOutcome::unsettled, TrialOutcome::unsettled, false},
        Case{Kind::release, ProbeOutcome::fell_off, TrialOutcome::fell_off, true}}) {
    ScriptedArm arm{};
    arm.answer = [&](const ProbeAction& action) {
      ProbeReport report = spring(action, 0);
      if (action.kind == each.kind) report.outcome = each.said;
      return report;
    };
    const TrialResult result = run_trial(arm, kOrder, {});
    EXPECT_EQ(result.outcome, each.outcome);
    EXPECT_EQ(arm.kinds().back(), Kind::lift);
    EXPECT_EQ(arm.kinds()[arm.asked.size() - 2], each.kind);
    const std::optional<Sample> sample = sample_of(kOrder, result, 0);
    EXPECT_EQ(sample.has_value(), each.is_sample);
    if (sample) {
      EXPECT_TRUE(sample->slipped);
      EXPECT_TRUE(sample->b.allFinite());
    }
  }
}

// Each stage ends in time, also if the arm claims success.
TEST(ProbingProgram, AnActionBeyondItsTimeCountsAsTimedOut) {
  for (const Kind late : {Kind::travel, Kind::touch, Kind::press, Kind::drag, Kind::release}) {
    ScriptedArm arm{};
    arm.answer = [&](const ProbeAction& action) {
      ProbeReport report = spring(action, 0);
      if (action.kind == late) report.seconds = 1.001 * action.time_limit;
      return report;
    };
    EXPECT_EQ(run_trial(arm, kOrder, {}).outcome, TrialOutcome::timed_out);
    EXPECT_EQ(arm.kinds().back(), Kind::lift);
  }
}

TEST(ProbingProgram, AdvancingIsAPureFunction) {
  const ProgramStep first = begin_trial(kOrder, {});
  const ProbeReport report{ProbeOutcome::done, {1, 2, 3}, 2};
  const ProgramStep once = advance(first.state, report, {}),
                    again = advance(first.state, report, {});
  EXPECT_EQ(once.state.stage, ProgramStage::touch);
  EXPECT_EQ(again.state.stage, once.state.stage);
  EXPECT_EQ(again.state.result.seconds, 2);
  EXPECT_EQ(first.state.result.seconds, 0);
}

TEST(ProbingProgram, ASampleSaysWhatTheTrialGave) {
  ScriptedArm arm{};
  arm.answer = [](const ProbeAction& action) { return spring(action, 4); };
  const TrialResult result = run_trial(arm, kOrder, {});
  const Sample sample = *sample_of(kOrder, result, 77);
  EXPECT_EQ(sample.id, 5);
  EXPECT_EQ(sample.contact, 2);
  EXPECT_EQ(sample.group, 2003);
  EXPECT_EQ(sample.force, Vector3d(0.5, 0, 1));
  EXPECT_EQ(sample.a, result.a);
  EXPECT_EQ(sample.b, result.b);
  EXPECT_TRUE(sample.slipped);
  EXPECT_EQ(sample.time, 77);
}

}  // namespace
}  // namespace palpate::probing
