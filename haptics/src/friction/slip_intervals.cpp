// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "friction/slip_intervals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

// Two normal forces belong to one level if they differ by at most this share of the larger one plus
// the noise of both.
constexpr double kSameLevel = 0.1;
// [rad] Two forces have the same direction if their angles differ by at most this (2.5 degrees); an
// arm probes about a dozen directions.
constexpr double kSameDirection = 0.044;
// A tangential force has a direction if it exceeds this many standard deviations of the noise.
constexpr double kNoticeable = 3;

struct Polar {
  const FrictionTrial* trial;
  double normal, tangential, angle;
};

double angle_distance(double from, double to) {
  return std::abs(std::remainder(to - from, 2 * std::numbers::pi));
}

// Splits a sorted range between neighbours for which `apart` holds.
template <typename Value, typename Apart>
std::vector<std::span<Value>> split(std::span<Value> sorted, Apart apart) {
  std::vector<std::span<Value>> parts;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= sorted.size(); ++i) {
    if (i < sorted.size() && !apart(sorted[i - 1], sorted[i])) continue;
    parts.push_back(sorted.subspan(begin, i - begin));
    begin = i;
  }
  return parts;
}

// Runs of one direction among values sorted by angle; a run across +-pi is not split.
template <typename Value>
std::vector<std::span<Value>> split_directions(std::span<Value> values, double Value::*angle) {
  const auto less = [&](const Value& a, const Value& b) { return a.*angle < b.*angle; };
  const auto apart = [&](const Value& a, const Value& b) {
    return angle_distance(a.*angle, b.*angle) > kSameDirection;
  };
  std::sort(values.begin(), values.end(), less);
  // Start after a gap.
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!apart(values[i - 1], values[i])) continue;
    std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(i), values.end());
    break;
  }
  return split(values, apart);
}

std::optional<SlipInterval> interval(std::span<const Polar> direction, const Polar* pressed,
                                     const Eigen::Vector3d& pressing) {
  const Polar *held = pressed, *slipped = nullptr;
  for (const Polar& polar : direction) {
    if (polar.trial->slipped) {
      if (!slipped || polar.tangential < slipped->tangential) slipped = &polar;
    } else if (!held || polar.tangential > held->tangential) {
      held = &polar;
    }
  }
  if (!slipped) return std::nullopt;
  return SlipInterval{.held = held ? held->trial->force : slipped->normal * pressing,
                      .slipped = slipped->trial->force,
                      .direction = slipped->angle};
}

// Calls `visit` with the trials of each direction at each level, the trial there without a
// tangential force that held, or null, and the number of the level.
template <typename Visit>
void for_each_direction(std::span<const FrictionTrial> trials, const Eigen::Vector3d& pressing,
                        double force_noise, const Visit& visit) {
  const Eigen::Matrix3d frame = rotation_between(Eigen::Vector3d::UnitZ(), pressing);
  std::vector<Polar> polars;
  for (const FrictionTrial& trial : trials) {
    const Eigen::Vector3d f = frame.transpose() * trial.force;
    polars.push_back({&trial, f.z(), std::hypot(f.x(), f.y()), std::atan2(f.y(), f.x())});
  }
  std::sort(polars.begin(), polars.end(),
            [](const Polar& a, const Polar& b) { return a.normal < b.normal; });
  int level_index = 0;
  for (const std::span<Polar> level : split(std::span(polars), [&](const Polar&a, const Polar&b) {
         return b.normal - a.normal > kSameLevel * b.normal + 2 * force_noise;
       })) {
    const auto pushed = std::partition(level.begin(), level.end(), [&](const Polar& polar) {
      return polar.tangential <= kNoticeable * force_noise;
    });
    const auto pressed = std::find_if(level.begin(), pushed,
                                      [](const Polar& polar) { return !polar.trial->slipped; });
    const std::span<Polar> tried(pushed, level.end());
    for (const std::span<Polar> direction : split_directions(tried, &Polar::angle))
      visit(direction, pressed == pushed ? nullptr : &*pressed, level_index);
    ++level_index;
  }
}

}  // namespace

std::vector<SlipInterval> slip_intervals(std::span<const FrictionTrial> trials,
                                         const Eigen::Vector3d& pressing, double force_noise) {
  std::vector<SlipInterval> intervals;
  for_each_direction(trials, pressing, force_noise,
                     [&](std::span<const Polar> direction, const Polar* pressed, int level) {
                       std::optional<SlipInterval> found = interval(direction, pressed, pressing);
                       if (!found) return;
                       found->level = level;
                       intervals.push_back(*found);
                     });
  return intervals;
}

bool are_searches(std::span<const FrictionTrial> trials, const Eigen::Vector3d& pressing,
                  double force_noise) {
  constexpr std::size_t kNoSearch = 2;
  int searched = 0, others = 0;
  for_each_direction(trials, pressing, force_noise,
                     [&](std::span<const Polar> direction, const Polar*, int) {
                       ++(direction.size() > kNoSearch ? searched : others);
                     });
  return searched >= others;
}

int count_directions(std::span<const SlipInterval> intervals) {
  std::vector<SlipInterval> copies(intervals.begin(), intervals.end());
  return static_cast<int>(split_directions(std::span(copies), &SlipInterval::direction).size());
}

int count_levels(std::span<const SlipInterval> intervals) {
  int count = 0, last = -1;
  for (const SlipInterval& each : intervals) {
    if (each.level != last) ++count;
    last = each.level;
  }
  return count;
}

}  // namespace palpate::haptics
