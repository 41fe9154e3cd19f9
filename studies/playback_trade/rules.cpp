// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "measure.h"
#include "tables.h"

namespace palpate::bench {
namespace {

using haptics::ContactMotion;

constexpr int kTimings = 6;  // of which the shortest counts, for each tick

struct SlideFigures {
  double mean_us = 0;             // of slips
  std::vector<double> residuals;  // [N] of slips
  std::vector<double> errors;     // [N] from the force of the exact rule, from the same state
};

/// The state, as another playback's.
haptics::LoopState handed_over(const haptics::LoopState& state, const haptics::LoopState& to) {
  haptics::LoopState copy = state;
  copy.playback = to.playback;
  copy.has_place = false;
  copy.place = {};
  return copy;
}

SlideFigures slide(const TouchedObject& object, const haptics::PlaybackOptions& options,
                   const std::vector<Eigen::Vector3d>& path) {
  const haptics::Playback playback(object.model, unlimited(options));
  const haptics::Playback exact(object.model,
                                unlimited({.tolerance = 1e-9, .energy_credit = kInfinite}));
  SlideFigures figures;
  // Each along its own way, for the times and residuals.
  std::vector<double> times(path.size(), kInfinite);
  std::vector<bool> slips(path.size());
  for (int repeat = 0; repeat < kTimings; ++repeat) {
    haptics::LoopState state;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const auto begin = std::chrono::steady_clock::now();
      const haptics::Command command = playback.step(path[i], state);
      const double us =
          1e6 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      times[i] = std::min(times[i], us);
      slips[i] = command.state == haptics::ContactState::slip;
      if (repeat == 0 && slips[i]) figures.residuals.push_back(residual(state, command));
    }
  }
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!slips[i]) continue;
    sum += times[i];
    ++count;
  }
  figures.mean_us = count > 0 ? sum / count : 0;
  // Both from the states of the exact one, for the error.
  haptics::LoopState state, own;
  static_cast<void>(playback.step(path.front(), own));
  for (const Eigen::Vector3d& tool : path) {
    haptics::LoopState copy = handed_over(state, own);
    const bool known = state.has_proxy;
    const haptics::Command truth = exact.step(tool, state);
    if (!known || truth.state != haptics::ContactState::slip) continue;
    const haptics::Command command = playback.step(tool, copy);
    figures.errors.push_back((command.force - truth.force).norm());
  }
  return figures;
}

double at_three(double) { return 3; }

}  // namespace

void print_tolerances() {
  constexpr int kTicks = 8000;
  const TouchedObject object = hills(0.5);
  const std::vector<Eigen::Vector3d> path = wander(object, kTicks, 3, at_three);
  fmt::print(
      "\n| tolerance [N] | slip: mean [us] | residual: median, largest [mN] | error: median, 99 %, "
      "largest [mN] |\n|---|---|---|---|\n");
  for (const double tolerance : {1e-5, 1e-4, 2e-4, 1e-3, 1e-2}) {
    const SlideFigures f =
        slide(object, {.tolerance = tolerance, .energy_credit = kInfinite}, path);
    fmt::print("| {} | {:.2f} | {:.2g}, {:.2g} | {:.2g}, {:.2g}, {:.2g} |\n", tolerance, f.mean_us,
               1e3 * quantile(f.residuals, 0.5), 1e3 * quantile(f.residuals, 1),
               1e3 * quantile(f.errors, 0.5), 1e3 * quantile(f.errors, 0.99),
               1e3 * quantile(f.errors, 1));
  }
}

void print_rules(int ticks) {
  fmt::print(
      "\n| object | friction | rule | slip: mean [us] | residual: median, 99 % [mN] | error: "
      "median, 99 % [mN] |\n|---|---|---|---|---|---|\n");
  for (const double friction : {0.5, 0.2, 0.05}) {
    for (const TouchedObject& object : touched_objects(friction)) {
      const std::vector<Eigen::Vector3d> path = wander(object, ticks, 3, at_three);
      for (const auto& [rule, name] :
           {std::pair(ContactMotion::bracketed, "bracketed"),
            std::pair(ContactMotion::brent, "brent"),
            std::pair(ContactMotion::friction_boundary, "friction_boundary")}) {
        haptics::PlaybackOptions options{.motion = rule};
        if (rule == ContactMotion::bracketed) options.energy_credit = kInfinite;
        const SlideFigures f = slide(object, options, path);
        fmt::print("| {} | {} | {} | {:.2g} | {:.2g}, {:.2g} | {:.2g}, {:.2g} |\n", object.name,
                   friction, name, f.mean_us, 1e3 * quantile(f.residuals, 0.5),
                   1e3 * quantile(f.residuals, 0.99), 1e3 * quantile(f.errors, 0.5),
                   1e3 * quantile(f.errors, 0.99));
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace palpate::bench
