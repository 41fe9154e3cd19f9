// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "whole/project_record.h"
#include "whole/run_calls.h"

namespace palpate::apps {

/// Reads files, and all files in folders. Hidden files do not count, nor do records (.jsonl) and
/// journals of shards, which hold times. Beside a range map, what its command reads too: the rig,
/// and the files that `palpate decode` writes for the same frame. Paths that do not exist are left
/// out.
[[nodiscard]] Fingerprints fingerprints_of(const std::vector<fs::path>& paths);

/// Why a step is to be done that was done, or begun, before: in words, the most important first;
/// empty if nothing has changed.
/// \param now what it would be done with.
/// \param there its outputs that exist.
[[nodiscard]] std::vector<std::string> changes_since(const StepRecord& before,
                                                     const StepRecord& now,
                                                     const Fingerprints& there);

/// Returns true if nothing has changed since an unfinished step began.
[[nodiscard]] bool can_be_resumed(const StepRecord& before, const StepRecord& now);

/// Checks that all files where a step would write are as `palpate run` has left them.
/// \param before null if the step was never begun.
/// \throws InvalidInput that names the first that is not, and what to do.
void check_own(const std::string& step, const StepRecord* before, const Fingerprints& there);

/// The need to do a step.
enum class StepNeed {
  none,     ///< nothing has changed
  due,      ///< it must be done
  depends,  ///< it must be done if an earlier step writes something else than before
};

struct StepPlan {
  StepNeed need = StepNeed::none;
  std::string reason = {};  ///< in words
};

/// The version, settings and inputs of a step as they are now.
[[nodiscard]] StepRecord now_of(const StepCall& call);

/// Plans a step, for the time when all earlier ones are done.
/// \throws InvalidInput if it would replace what `palpate run` did not write, or measurements.
[[nodiscard]] StepPlan plan_step(const StepCall& call, const StepRecord* before,
                                 const StepRecord& now);

/// The same of all steps before the first is done.
[[nodiscard]] std::vector<StepPlan> plan_steps(const std::vector<StepCall>& calls,
                                               const ProjectRecord& record);

}  // namespace palpate::apps
