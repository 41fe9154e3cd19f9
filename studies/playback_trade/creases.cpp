// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "crease_model.h"
#include "measure.h"
#include "tables.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

const std::vector<double> kOpenings = {20, 30, 45, 60, 90};

TouchedObject creases(double friction) {
  return {"creases", haptics::crease_model({.openings = kOpenings, .friction = friction})};
}

/// A tool on straight ways at 30 mm/s, and what its user feels.
struct FeelingTool {
  const haptics::Playback& playback;
  const haptics::CreaseProfile& profile;
  Vector3d place;
  haptics::LoopState state = {};
  haptics::Command last = {};
  double work = 0;                                  // [N mm] of the object on the user
  double largest_change = 0;                        // [N] in a tick
  double least_force = kInfinite, before_fall = 0;  // [N]
  int falls = 0, fallen = 0, ticks = 0, changes = 0;

  void step(const Vector3d& next) {
    constexpr double kLeastDepth = 0.02, kLargeChange = 0.2;  // [mm], [N]
    const haptics::Command now = playback.step(next, state);
    work += (now.force + last.force).dot(next - place) / 2;
    const double change = (now.force - last.force).norm();
    largest_change = std::max(largest_change, change);
    changes += change > kLargeChange;
    ++ticks;
    const bool falls_now =
        now.state == haptics::ContactState::free && profile.depth(next) > kLeastDepth;
    if (falls_now && last.state != haptics::ContactState::free) {
      ++falls;
      before_fall = std::max(before_fall, last.force.norm());
    }
    fallen += falls_now;
    if (profile.depth(next) > kLeastDepth) least_force = std::min(least_force, now.force.norm());
    place = next;
    last = now;
  }
  void go(const Vector3d& to, double length = 0.03) {
    const Vector3d from = place;
    const int steps = static_cast<int>(std::ceil((to - from).norm() / length));
    for (int i = 1; i <= steps; ++i) step(from + (to - from) * i / steps);
  }
};

/// Across a groove inside both flanks, along them, and round the bottom or as far from it as the
/// flanks' parallels lead.
FeelingTool sweep(const haptics::Playback& playback, const haptics::CreaseProfile& profile,
                  std::size_t groove, double depth, bool round, double y) {
  const double half = kOpenings[groove] / 2 * std::numbers::pi / 180;
  const Vector3d bottom(profile.bottom(groove), y, -haptics::CreaseProfile::kDepth);
  const Vector3d up(-std::sin(half), 0.05, std::cos(half)), in(-std::cos(half), 0, -std::sin(half));
  const auto mirrored = [](const Vector3d& v) { return Vector3d(-v.x(), v.y(), v.z()); };
  constexpr double kHeight = 5;  // [mm] along the flank
  const Vector3d middle =
      bottom + kHeight * up -
      kHeight * std::sin(half) / std::cos(half) * 0.9 * Vector3d(in.x(), 0, in.z());
  FeelingTool tool{playback, profile, middle};
  static_cast<void>(playback.step(middle, tool.state));
  tool.go(bottom + kHeight * up + depth * in);
  tool.least_force = kInfinite;
  if (round) {
    tool.go(bottom + depth * in);
    const double sector = std::numbers::pi - 2 * half;
    const int steps = static_cast<int>(std::ceil(sector * depth / 0.03));
    for (int i = 1; i <= steps; ++i) {
      const double angle = half + sector * i / steps;
      tool.step(bottom + depth * Vector3d(-std::cos(angle), 0, -std::sin(angle)));
    }
  } else {
    tool.go(bottom - depth / std::sin(half) * Vector3d::UnitZ());
  }
  tool.go(bottom + kHeight * mirrored(up) + depth * mirrored(in));
  return tool;
}

void print_sweeps(const TouchedObject& object, double friction) {
  const haptics::CreaseProfile profile(kOpenings);
  const haptics::Playback playback(object.model);
  for (std::size_t groove = 0; groove < kOpenings.size(); ++groove) {
    int fallen = 0, longest = 0, changes = 0;
    double before = 0, least = kInfinite, change = 0;
    for (int i = 0; i < 16; ++i) {
      const FeelingTool tool = sweep(playback, profile, groove, 0.5 + 2.5 * (i / 2) / 7.0,
                                     i % 2 == 0, -18 + 5 * (i / 2));
      fallen += tool.falls > 0;
      longest = std::max(longest, tool.fallen);
      before = std::max(before, tool.before_fall);
      least = std::min(least, tool.least_force);
      change = std::max(change, tool.largest_change);
      changes += tool.changes;
    }
    fmt::print("| {} | {} | {} of 16, {}, {:.2g} | {:.2g} | {}, {:.2g} |\n", friction,
               kOpenings[groove], fallen, longest, before, least, changes, change);
  }
}

/// A place to press at from outside, at least 12 mm from the border.
struct OutsidePlace {
  Vector3d outside, at, normal, along;
};

/// In front of the place by up to 1 mm, and as far from the opposite flank.
OutsidePlace outside_place(const TouchedObject& object, std::mt19937& random) {
  const haptics::CreaseProfile profile(kOpenings);
  while (true) {
    const PressPlace at = press_place(object, random);
    const auto opposite =
        object.query.first_hit(at.position + 1e-6 * at.normal, at.position + 2 * at.normal);
    const double free = opposite ? (opposite->position - at.position).norm() / 2 : 1;
    const Vector3d outside = at.position + free * at.normal;
    // From the very bottom of a groove the normal may lead into the opposite flank at once.
    if (profile.depth(outside) < 0) return {outside, at.position, at.normal, at.along};
  }
}

void print_loops(const TouchedObject& object, double friction, int loops, unsigned seed) {
  const haptics::CreaseProfile profile(kOpenings);
  const haptics::Playback playback(object.model);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> works;
  int falls = 0, changes = 0, ticks = 0;
  double change = 0;
  for (int i = 0; i < loops; ++i) {
    const OutsidePlace at = outside_place(object, random);
    const double depth = 0.5 + 4.5 * uniform(random), length = 15 * uniform(random);
    FeelingTool tool{playback, profile, at.outside};
    static_cast<void>(playback.step(tool.place, tool.state));
    const Vector3d pressed = at.at - depth * at.normal;
    tool.go(pressed);
    tool.go(pressed + length * at.along);
    tool.go(pressed + length * at.along + 30 * Vector3d::UnitZ());
    if (tool.last.state != haptics::ContactState::free || tool.last.force.norm() > 0) continue;
    works.push_back(tool.work);
    falls += tool.falls;
    changes += tool.changes;
    ticks += tool.ticks;
    change = std::max(change, tool.largest_change);
  }
  fmt::print("| {} | {} | {:.2g}, {:.2g} | {} | {} of {}, {:.2g} |\n", friction, works.size(),
             share_above(works, 0.05), quantile(works, 1), falls, changes, ticks, change);
}

void print_jumps(const TouchedObject& object, double friction, int jumps) {
  const haptics::Playback playback(object.model, unlimited({.energy_credit = kInfinite}));
  for (const double jump : {0.3, 2.0, 10.0}) {
    std::mt19937 random(7);
    std::vector<double> all;
    int lost = 0, restless = 0;
    for (int i = 0; i < jumps; ++i) {
      const OutsidePlace at = outside_place(object, random);
      haptics::LoopState state;
      static_cast<void>(playback.step(at.outside, state));
      const Vector3d pressed = at.at - 3 * at.normal;
      static_cast<void>(playback.step(pressed, state));
      const haptics::Command command = playback.step(pressed + jump * at.along, state);
      lost += command.state == haptics::ContactState::free;
      if (command.state != haptics::ContactState::slip) continue;
      all.push_back(residual(state, command));
      const haptics::Command again = playback.step(pressed + jump * at.along, state);
      restless += again.state == haptics::ContactState::slip;
    }
    fmt::print("| {} | {} | {} | {:.2g}, {:.3g} | {} | {} |\n", friction, jump, all.size(),
               share_above(all, 1e-3), 1e3 * quantile(all, 1), lost, restless);
  }
}

void print_walks(const TouchedObject& object, double friction, double seconds) {
  const haptics::CreaseProfile profile(kOpenings);
  const haptics::Playback playback(object.model);
  for (const unsigned seed : {1U, 2U}) {
    const std::vector<Vector3d> path =
        wander(object, static_cast<int>(1e3 * seconds), seed, touching);
    FeelingTool tool{playback, profile, path.front()};
    for (const Vector3d& place : path) tool.step(place);
    fmt::print("| {} | {} | {}, {}, {:.2g} | {}, {:.2g} |\n", friction, seed, tool.falls,
               tool.fallen, tool.before_fall, tool.changes, tool.largest_change);
  }
}

}  // namespace

void print_creases(int loops, int jumps, double seconds) {
  const auto frictions = {0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.9, 1.0};
  fmt::print(
      "\n| friction | opening | sweeps that fall, most ticks, force before [N] | least force [N] | "
      "changes above 0.2 N in a tick, largest [N] |\n|---|---|---|---|---|\n");
  for (const double friction : frictions) print_sweeps(creases(friction), friction);
  fmt::print(
      "\n| friction | loops | returning more than 0.05 N mm [%], most [N mm] | falls | changes "
      "above "
      "0.2 N, largest [N] |\n|---|---|---|---|---|\n");
  for (const double friction : frictions) {
    const TouchedObject object = creases(friction);
    for (const unsigned seed : {11U, 12U}) print_loops(object, friction, loops, seed);
  }
  fmt::print(
      "\n| friction | jump [mm] | slips | beyond 1 mN [%], largest [mN] | lost | restless "
      "|\n|---|---|---|---|---|---|\n");
  for (const double friction : frictions) print_jumps(creases(friction), friction, jumps);
  fmt::print(
      "\n| friction | path | falls, ticks, force before [N] | changes above 0.2 N, largest [N] "
      "|\n|---|---|---|---|\n");
  for (const double friction : frictions) print_walks(creases(friction), friction, seconds);
}

}  // namespace palpate::bench
