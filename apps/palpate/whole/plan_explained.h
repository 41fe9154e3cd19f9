// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "palpate/haptics/error_budget.h"
#include "palpate/haptics/plan_scene.h"
#include "palpate/haptics/scene_requirement.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Whether the sources of the expected error are shown, and what is known of the set-up.
struct PlanExplanation {
  bool is_wanted = false;
  haptics::SurfaceErrors surface;
};

/// Adds `--explain` and the options that need it.
void add_explain_options(CLI::App& command, PlanExplanation& explanation);

/// The sources of the error that a plan expects, as figures: each in newtons.
/// \param slip_tolerance [N] `PlaybackOptions::tolerance` of the object.
[[nodiscard]] Json budget_figures(const haptics::ErrorBudget& budget,
                                  const haptics::SurfaceErrors& known, double slip_tolerance);

/// The same as a table, the largest source first, and what it does not contain.
[[nodiscard]] std::string budget_in_words(const haptics::ObjectPlan& plan,
                                          const haptics::SurfaceErrors& known,
                                          double slip_tolerance);

}  // namespace palpate::apps
