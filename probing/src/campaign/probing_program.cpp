// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/probing_program.h"

#include <limits>
#include <utility>

namespace palpate::probing {
namespace {

const Eigen::Vector3d kUnknown =
    Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

double limit_of(ProgramStage stage, const ProgramOptions& options) {
  switch (stage) {
    case ProgramStage::travel:
      return options.travel_limit;
    case ProgramStage::touch:
      return options.touch_limit;
    case ProgramStage::lift:
      return options.lift_limit;
    default:
      return options.settle_limit;
  }
}

// The first action of a stage.
std::optional<ProbeAction> action_of(const ProgramState& state, const ProgramOptions& options) {
  const TrialOrder& order = state.order;
  ProbeAction action{.trial = order.trial,
                     .target = order.contact.position,
                     .force = order.normal_force,
                     .time_limit = limit_of(state.stage, options)};
  switch (state.stage) {
    case ProgramStage::travel:
      action.kind = ProbeActionKind::travel;
      action.force += order.tangential_force;
      break;
    case ProgramStage::touch:
      action.kind = ProbeActionKind::touch;
      return action;
    case ProgramStage::press:
      action.kind = ProbeActionKind::press;
      action.measures_sample = order.direction < 0;
      return action;
    case ProgramStage::drag:
      action.kind = ProbeActionKind::drag;
      action.force += order.tangential_force;
      action.measures_sample = true;
      return action;
    case ProgramStage::release:
      action.kind = ProbeActionKind::release;
      return action;
    case ProgramStage::lift:
      action.kind = ProbeActionKind::lift;
      break;
    case ProgramStage::finished:
      return std::nullopt;
  }
  action.target += options.clearance * order.contact.normal;
  return action;
}

ProgramStep enter(ProgramState state, ProgramStage stage, const ProgramOptions& options) {
  state.stage = stage;
  const std::optional<ProbeAction> action = action_of(state, options);
  return {std::move(state), action};
}

TrialOutcome failure(ProbeOutcome outcome) {
  switch (outcome) {
    case ProbeOutcome::no_contact:
      return TrialOutcome::no_contact;
    case ProbeOutcome::fell_off:
      return TrialOutcome::fell_off;
    case ProbeOutcome::unsettled:
      return TrialOutcome::unsettled;
    default:
      return TrialOutcome::timed_out;
  }
}

// Nullopt if the arm reported values that are not finite.
std::optional<SlipJudgement> judge(const TrialOrder& order, const TrialResult& result,
                                   const ProgramOptions& options) {
  return judge_slip(slip_trial(order, result), {.position_deviation = options.position_noise,
                                                .force_deviation = options.force_noise,
                                                .threshold = order.slip_threshold,
                                                .microslip = order.microslip});
}

// Takes the parts of a sample from the report of the action that measures it.
void take_sample(TrialResult& result, const ProbeReport& report) {
  result.b = report.position;
  result.range_map = report.range_map;
  result.no_range_map = report.no_range_map;
}

// The stage after an action that succeeded.
ProgramStage record_and_proceed(ProgramState& state, const ProbeReport& report,
                                const ProgramOptions& options) {
  TrialResult& result = state.result;
  switch (state.stage) {
    case ProgramStage::travel:
      return ProgramStage::touch;
    case ProgramStage::touch:
      result.touch = report.position;
      return ProgramStage::press;
    case ProgramStage::press:
      result.a = report.position;
      if (state.order.direction >= 0) return ProgramStage::drag;
      take_sample(result, report);
      result.outcome = TrialOutcome::held;
      return ProgramStage::lift;
    case ProgramStage::drag:
      take_sample(result, report);
      result.creep = report.creep;
      result.work_dragging = report.work;
      return ProgramStage::release;
    case ProgramStage::release:
      result.a_again = report.position;
      result.work_releasing = report.work;
      if (const std::optional<SlipJudgement> judged = judge(state.order, result, options)) {
        result.slip_statistic = judged->t_squared;
        result.outcome = judged->slipped ? TrialOutcome::slipped : TrialOutcome::held;
      }
      return ProgramStage::lift;
    default:
      return ProgramStage::finished;
  }
}

}  // namespace

const char* to_string(ProbeOutcome outcome) {
  switch (outcome) {
    case ProbeOutcome::done:
      return "done";
    case ProbeOutcome::no_contact:
      return "no_contact";
    case ProbeOutcome::fell_off:
      return "fell_off";
    case ProbeOutcome::unsettled:
      return "unsettled";
    case ProbeOutcome::timed_out:
      return "timed_out";
  }
  return "";
}

const char* to_string(TrialOutcome outcome) {
  switch (outcome) {
    case TrialOutcome::held:
      return "held";
    case TrialOutcome::slipped:
      return "slipped";
    case TrialOutcome::fell_off:
      return "fell_off";
    case TrialOutcome::no_contact:
      return "no_contact";
    case TrialOutcome::unsettled:
      return "unsettled";
    case TrialOutcome::timed_out:
      return "timed_out";
  }
  return "";
}

ProgramStep begin_trial(const TrialOrder& order, const ProgramOptions& options) {
  ProgramState state{.order = order};
  state.result = {.touch = kUnknown,
                  .a = kUnknown,
                  .b = kUnknown,
                  .a_again = kUnknown,
                  .slip_statistic = std::numeric_limits<double>::quiet_NaN()};
  return enter(std::move(state), ProgramStage::travel, options);
}

ProgramStep advance(const ProgramState& before, const ProbeReport& report,
                    const ProgramOptions& options) {
  ProgramState state = before;
  state.result.seconds += report.seconds;
  // Failures after the lift do not matter to the trial.
  if (state.stage == ProgramStage::lift || state.stage == ProgramStage::finished)
    return enter(std::move(state), ProgramStage::finished, options);
  const bool late = report.seconds > limit_of(state.stage, options);
  if (!late && report.outcome == ProbeOutcome::done) {
    const ProgramStage next = record_and_proceed(state, report, options);
    return enter(std::move(state), next, options);
  }
  state.result.outcome = late ? TrialOutcome::timed_out : failure(report.outcome);
  state.result.reason = report.reason;
  if (state.stage == ProgramStage::drag && state.result.outcome == TrialOutcome::fell_off)
    state.result.b = report.position;
  return enter(std::move(state), ProgramStage::lift, options);
}

TrialResult run_trial(Prober& arm, const TrialOrder& order, const ProgramOptions& options) {
  ProgramStep step = begin_trial(order, options);
  while (step.action) step = advance(step.state, arm.perform(*step.action), options);
  return step.state.result;
}

SlipTrial slip_trial(const TrialOrder& order, const TrialResult& result) {
  return {.contact = result.touch,
          .normal_force = order.normal_force,
          .tangential_force = order.tangential_force,
          .a = result.a,
          .b = result.b,
          .a_again = result.a_again};
}

std::optional<Sample> sample_of(const TrialOrder& order, const TrialResult& result, double time) {
  const bool is_sample =
      result.outcome == TrialOutcome::held || result.outcome == TrialOutcome::slipped ||
      (result.outcome == TrialOutcome::fell_off && result.a.allFinite() && result.b.allFinite());
  if (!is_sample) return std::nullopt;
  Sample sample{.id = order.trial,
                .contact = order.contact.id,
                .group = order.contact.id * 1000 + order.level,
                .force = order.normal_force + order.tangential_force,
                .a = result.a,
                .b = result.b,
                .slipped = result.outcome != TrialOutcome::held,
                .time = time};
  if (!result.range_map.empty()) sample.range_map = result.range_map;
  return sample;
}

}  // namespace palpate::probing
