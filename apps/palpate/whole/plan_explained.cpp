// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/plan_explained.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "shared/call_checks.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

struct StatedSource {
  const char* key;
  const char* words;
  double haptics::ErrorBudget::*error;
};
constexpr std::array kStated{
    StatedSource{"force_noise", "noise of the forces", &haptics::ErrorBudget::force_noise},
    StatedSource{"position_noise", "noise of the tool's positions",
                 &haptics::ErrorBudget::position_noise},
    StatedSource{"fit", "fits of the contacts", &haptics::ErrorBudget::fit},
    StatedSource{"across", "directions that were not measured", &haptics::ErrorBudget::across},
    StatedSource{"spacing", "distance between contacts", &haptics::ErrorBudget::spacing},
    StatedSource{"contrast", "blending of contacts that differ", &haptics::ErrorBudget::contrast}};

struct SurfaceSource {
  const char* key;
  const char* words;
  double haptics::ErrorBudget::*slope;
  std::optional<double> haptics::SurfaceErrors::*size;
};
constexpr std::array kSurface{
    SurfaceSource{"depth_noise", "noise of the depths", &haptics::ErrorBudget::per_depth_noise,
                  &haptics::SurfaceErrors::depth_noise},
    SurfaceSource{"depth_offset", "offset of the depths", &haptics::ErrorBudget::per_depth_offset,
                  &haptics::SurfaceErrors::depth_offset},
    SurfaceSource{"registration", "registration along the surface",
                  &haptics::ErrorBudget::per_registration, &haptics::SurfaceErrors::registration}};

// [mm] A usual error of a set-up, for those that are not given.
constexpr double kExample = 0.1;

struct BudgetRow {
  std::string words;
  double error = 0;  // [N]
};

}  // namespace

void add_explain_options(CLI::App& command, PlanExplanation& explanation) {
  CLI::Option* explain =
      command.add_flag("--explain", explanation.is_wanted,
                       "List the sources of the expected error and their shares");
  const auto add_error = [&](const char* name, std::optional<double>& to, const char* what) {
    add_number(command, name, to, at_least(0).finite(), what)
        ->needs(explain)
        ->group("With --explain");
  };
  add_error("--depth-noise", explanation.surface.depth_noise,
            "Standard deviation of the depth of each vertex of the surface [mm]");
  add_error("--depth-offset", explanation.surface.depth_offset,
            "Standard deviation of the depth of the whole surface, from the calibration [mm]");
  add_error(
      "--registration", explanation.surface.registration,
      "Root mean square of the length of the shift between arm and camera along the surface [mm]");
}

Json budget_figures(const haptics::ErrorBudget& budget, const haptics::SurfaceErrors& known,
                    double slip_tolerance) {
  Json figures, slopes, surface;
  for (const StatedSource& source : kStated) figures[source.key] = budget.*source.error;
  for (const SurfaceSource& source : kSurface) {
    slopes[source.key] = budget.*source.slope;
    const std::optional<double>& size = known.*source.size;
    surface[source.key] = size ? Json(*size * budget.*source.slope) : Json(nullptr);
  }
  figures["stated"] = budget.stated();
  figures["surface"] = surface;
  figures["per_mm"] = slopes;
  figures["with_surface"] = budget.with(known);
  figures["slip_tolerance"] = slip_tolerance;
  return figures;
}

std::string budget_in_words(const haptics::ObjectPlan& plan, const haptics::SurfaceErrors& known,
                            double slip_tolerance) {
  const haptics::ErrorBudget& budget = plan.budget;
  std::vector<BudgetRow> rows;
  std::string unknown;
  for (const StatedSource& source : kStated) rows.push_back({source.words, budget.*source.error});
  for (const SurfaceSource& source : kSurface) {
    const double slope = budget.*source.slope;
    if (const std::optional<double>& size = known.*source.size) {
      rows.push_back({fmt::format("{}, {:.3g} mm", source.words, *size), *size * slope});
    } else {
      unknown += fmt::format("{}{}: {}", unknown.empty() ? "" : ", ", source.words,
                             newtons(kExample * slope, 3));
    }
  }
  std::ranges::stable_sort(rows, std::ranges::greater{}, &BudgetRow::error);
  const double total = budget.with(known);
  std::string words = fmt::format(
      "Sources of the expected error with {} contacts, {} in all (root of the sum of "
      "squares; shares of the square):\n",
      plan.planned.contacts, newtons(total, 3));
  for (const BudgetRow& row : rows) {
    if (row.error > 0) {
      words += fmt::format("  {:<36} {:>9} {:>5.0f} %\n", row.words, newtons(row.error, 3),
                           100 * row.error * row.error / (total * total));
    }
  }
  if (!unknown.empty())
    words += fmt::format("Not included. {:.2g} mm would cause: {}.\n", kExample, unknown);
  return words + fmt::format("The tolerance of slips in playback adds at most about {}.\n",
                             newtons(slip_tolerance));
}

}  // namespace palpate::apps
