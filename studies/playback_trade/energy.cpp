// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "measure.h"
#include "tables.h"

namespace palpate::bench {
namespace {

/// A tool on straight ways at 30 mm/s; counts the work of the object on the user, and where slips
/// end.
struct SlidingTool {
  const haptics::Playback& playback;
  Eigen::Vector3d place;
  haptics::LoopState state = {};
  haptics::Command last = {};
  double work = 0;  // [N mm]

  void go(const Eigen::Vector3d& to, std::vector<double>* beyond = nullptr) {
    constexpr double kStep = 0.03;  // [mm] in a tick
    const Eigen::Vector3d from = place;
    const int steps = static_cast<int>(std::ceil((to - from).norm() / kStep));
    for (int i = 1; i <= steps; ++i) {
      const Eigen::Vector3d next = from + (to - from) * i / steps;
      const haptics::Command now = playback.step(next, state);
      work += (now.force + last.force).dot(next - place) / 2;
      if (beyond != nullptr && now.state == haptics::ContactState::slip)
        beyond->push_back(residual(state, now));
      place = next;
      last = now;
    }
  }
};

struct EnergyFigures {
  std::vector<double> slides, jumps;  // [N] distance from the cone where slips end
  std::vector<double> works;          // [N mm] returned by each loop
};

EnergyFigures measure_energy(const TouchedObject& object, double credit, int loops, int jumps) {
  const haptics::Playback playback(object.model, unlimited({.energy_credit = credit}));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  EnergyFigures figures;
  constexpr double kLift = 12, kAbove = 1;  // [mm]
  for (int i = 0; i < loops; ++i) {
    const PressPlace at = press_place(object, random);
    const double depth = 3 + 2 * uniform(random), length = 15 * uniform(random);
    SlidingTool tool{playback, at.position + kAbove * at.normal};
    static_cast<void>(playback.step(tool.place, tool.state));
    const Eigen::Vector3d pressed = at.position - depth * at.normal;
    tool.go(pressed);
    tool.go(pressed + length * at.along, &figures.slides);
    tool.go(pressed + length * at.along + kLift * at.normal);
    figures.works.push_back(tool.work);
  }
  for (int i = 0; i < jumps; ++i) {
    const PressPlace at = press_place(object, random);
    const double jump = 0.1 * std::pow(100, uniform(random));
    haptics::LoopState state;
    static_cast<void>(playback.step(at.position + kAbove * at.normal, state));
    const Eigen::Vector3d pressed = at.position - 3 * at.normal;
    static_cast<void>(playback.step(pressed, state));
    const haptics::Command command = playback.step(pressed + jump * at.along, state);
    if (command.state == haptics::ContactState::slip)
      figures.jumps.push_back(residual(state, command));
  }
  return figures;
}

}  // namespace

void print_energy(int loops, int jumps) {
  constexpr double kBeyond = 1e-3;    // [N]
  constexpr double kReturned = 0.05;  // [N mm]
  fmt::print(
      "\n| object | friction | credit [N mm] | slides: beyond [%], 99 % [mN] | jumps: beyond [%], "
      "99 % [mN] | loops that return more than 0.05 N mm [%], most [N mm] "
      "|\n|---|---|---|---|---|---|\n");
  const auto print = [&](const TouchedObject& object, double friction) {
    for (const double credit : {kInfinite, kUsualCredit}) {
      const EnergyFigures f = measure_energy(object, credit, loops, jumps);
      fmt::print("| {} | {} | {} | {:.2g}, {:.2g} | {:.2g}, {:.2g} | {:.2g}, {:.2g} |\n",
                 object.name, friction, credit, share_above(f.slides, kBeyond),
                 1e3 * quantile(f.slides, 0.99), share_above(f.jumps, kBeyond),
                 1e3 * quantile(f.jumps, 0.99), share_above(f.works, kReturned),
                 quantile(f.works, 1));
      std::fflush(stdout);
    }
  };
  for (const double friction : {0.0, 0.05, 0.1, 0.2, 0.5, 0.9}) {
    print(sheet(false, friction), friction);
  }
  for (const double friction : {0.0, 0.3, 0.5, 1.0}) print(waves(friction), friction);
}

}  // namespace palpate::bench
