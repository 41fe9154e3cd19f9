// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "measure.h"
#include "tables.h"

namespace palpate::bench {
namespace {

struct Residuals {
  std::vector<double> all;  // [N] of slips
  int lost = 0;             // contacts that ended
};

Residuals after_jumps(const TouchedObject& object, double credit, double jump, int count) {
  constexpr double kDepth = 3;  // [mm]
  const haptics::Playback playback(object.model, unlimited({.energy_credit = credit}));
  std::mt19937 random(7);
  Residuals result;
  for (int i = 0; i < count; ++i) {
    const PressPlace at = press_place(object, random);
    haptics::LoopState state;
    static_cast<void>(playback.step(at.position + at.normal, state));
    const Eigen::Vector3d pressed = at.position - kDepth * at.normal;
    static_cast<void>(playback.step(pressed, state));
    const haptics::Command command = playback.step(pressed + jump * at.along, state);
    result.lost += command.state == haptics::ContactState::free;
    if (command.state == haptics::ContactState::slip)
      result.all.push_back(residual(state, command));
  }
  return result;
}

}  // namespace

void print_residuals(int jumps) {
  constexpr double kBeyond = 1e-3;  // [N]
  fmt::print(
      "\n| friction | credit [N mm] | jump [mm] | slips | beyond 1 mN [%], largest [mN]: all, by "
      "object |\n|---|---|---|---|---|\n");
  for (const double friction : {0.0, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0}) {
    const std::vector<TouchedObject> objects = touched_objects(friction);
    for (const double credit : {kInfinite, kUsualCredit}) {
      for (const double jump : {0.3, 2.0, 10.0}) {
        std::vector<double> all;
        std::string by_object;
        for (const TouchedObject& object : objects) {
          const Residuals r = after_jumps(object, credit, jump, jumps);
          all.insert(all.end(), r.all.begin(), r.all.end());
          by_object += fmt::format("; {} {:.2g}, {:.3g} ({})", object.name,
                                   share_above(r.all, kBeyond), 1e3 * quantile(r.all, 1), r.lost);
        }
        fmt::print("| {} | {} | {} | {} | {:.2g}, {:.3g}{} |\n", friction, credit, jump, all.size(),
                   share_above(all, kBeyond), 1e3 * quantile(all, 1), by_object);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace palpate::bench
