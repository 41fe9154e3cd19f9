// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/run_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "palpate/core/error.h"

namespace palpate::apps {
namespace {

/// "rig.yaml changed, and 3 more changes"
std::string changes_in_words(const std::vector<std::string>& changes) {
  const std::size_t more = changes.size() - 1;
  if (more == 0) return changes.front();
  return fmt::format("{}, and {} more change{}", changes.front(), more, more == 1 ? "" : "s");
}

/// \throws InvalidInput if a campaign is to be done again whose measurements are there.
void check_measurements(const StepCall& call, const StepRecord* before, const StepRecord& now,
                        const Fingerprints& there, const std::string& reason) {
  if (!call.step->measures || there.empty()) return;
  if (before != nullptr && can_be_resumed(*before, now)) return;
  throw InvalidInput(fmt::format(
      "{}: holds measurements, which are never replaced, but step '{}' is due ({}). Nothing was "
      "changed. Rename it, or undo the change; to keep its measurements, leave out the section "
      "and name it in section fit (acquisition).",
      there.begin()->first, call.step->name, reason));
}

StepPlan plan_with(const StepCall& call, const StepRecord* before, const StepRecord& now,
                   const std::optional<std::string>& awaited) {
  const Fingerprints there = fingerprints_of(call.outputs);
  StepPlan plan;
  const std::vector<std::string> changes = before == nullptr
                                               ? std::vector<std::string>{"not done before"}
                                               : changes_since(*before, now, there);
  if (!changes.empty())
    plan = {.need = StepNeed::due, .reason = changes_in_words(changes)};
  else if (awaited)
    plan = {.need = StepNeed::depends, .reason = "if " + *awaited + " writes something else"};
  if (plan.need != StepNeed::none) check_own(call.step->name, before, there);
  if (plan.need == StepNeed::due) check_measurements(call, before, now, there, plan.reason);
  return plan;
}

bool is_of(const fs::path& path, const StepCall& call) {
  return std::ranges::any_of(call.outputs,
                             [&](const fs::path& output) { return lies_in(path, output); });
}

/// Leaves out inputs that a step is going to write.
void forget(Fingerprints& inputs, const StepCall& writer) {
  std::erase_if(inputs, [&](const auto& input) { return is_of(input.first, writer); });
}

}  // namespace

StepRecord now_of(const StepCall& call) {
  StepRecord now{.version = PALPATE_VERSION,
                 .entries = in_utf8(call.entries),
                 .inputs = fingerprints_of(call.inputs)};
  for (const fs::path& output : call.outputs)
    now.writes.push_back(in_utf8(output.generic_string()));
  return now;
}

StepPlan plan_step(const StepCall& call, const StepRecord* before, const StepRecord& now) {
  return plan_with(call, before, now, std::nullopt);
}

std::vector<StepPlan> plan_steps(const std::vector<StepCall>& calls, const ProjectRecord& record) {
  std::vector<StepPlan> plans;
  std::vector<const StepCall*> writers;  // of what may change
  for (const StepCall& call : calls) {
    StepRecord now = now_of(call);
    const StepRecord* const known = record.find(call.step->name);
    std::optional<StepRecord> before;
    if (known != nullptr) before = *known;
    std::optional<std::string> awaited;
    for (const StepCall* writer : writers) {
      const bool reads = std::ranges::any_of(
          call.inputs, [&](const fs::path& input) { return is_of(input, *writer); });
      if (!reads) continue;
      awaited = writer->step->name;
      forget(now.inputs, *writer);
      if (before) forget(before->inputs, *writer);
    }
    plans.push_back(plan_with(call, before ? &*before : nullptr, now, awaited));
    if (plans.back().need != StepNeed::none) writers.push_back(&call);
  }
  return plans;
}

}  // namespace palpate::apps
