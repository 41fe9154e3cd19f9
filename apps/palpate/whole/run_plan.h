// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "whole/project_record.h"
#include "whole/run_calls.h"
#include "whole/run_changes.h"

namespace palpate::apps {

/// Whether a step is to be done.
enum class StepNeed {
  none,     ///< nothing has changed
  due,      ///< it must be done
  depends,  ///< it must be done if an earlier step writes something else than before
};

struct StepPlan {
  StepNeed need = StepNeed::none;
  std::string reason = {};  ///< in words
};

/// What a step would be done with now.
[[nodiscard]] StepRecord now_of(const StepCall& call);

/// Whether a step is to be done, once all earlier ones are.
/// \throws InvalidInput if it would replace what `palpate run` did not write, or measurements.
[[nodiscard]] StepPlan plan_step(const StepCall& call, const StepRecord* before,
                                 const StepRecord& now);

/// The same of all steps before the first is done.
[[nodiscard]] std::vector<StepPlan> plan_steps(const std::vector<StepCall>& calls,
                                               const ProjectRecord& record);

}  // namespace palpate::apps
