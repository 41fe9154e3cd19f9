// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "objects.h"
#include "palpate/haptics/playback.h"

namespace palpate::bench {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
/// [N mm] The usual credit of objects like the sheets of demo/, the same for all objects.
constexpr double kUsualCredit = 0.04;

/// Commands are the forces of the contact: nothing else shortens them.
inline haptics::PlaybackOptions unlimited(haptics::PlaybackOptions options = {}) {
  options.largest_jump = std::numeric_limits<double>::max();
  return options;
}

/// [N] ||f_T| - mu f_N| at the end of a slip; at most `beyond` counts as on the cone.
inline double residual(const haptics::LoopState& state, const haptics::Command& command) {
  return std::abs(haptics::friction_parts(state.place, -command.force).excess);
}

/// [mm] A depth for `wander`: between 1 above the surface and 3 below it.
inline double touching(double time) {
  const double phase = 2 * std::numbers::pi * 0.8 * time;
  return 1 + 2 * std::sin(phase + 0.7 * std::sin(0.31 * phase));
}

/// Of numbers in any order; 0 for none.
inline double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// [%] of the values that are above a limit.
inline double share_above(const std::vector<double>& values, double limit) {
  if (values.empty()) return 0;
  const auto above = std::count_if(values.begin(), values.end(),
                                   [limit](double value) { return !(value <= limit); });
  return 100 * static_cast<double>(above) / static_cast<double>(values.size());
}

/// A place to press at: at least 12 mm from the border, or 4 on the narrow hand.
struct PressPlace {
  Eigen::Vector3d position, normal, along;  ///< a unit tangent at random
};

inline PressPlace press_place(const TouchedObject& object, std::mt19937& random) {
  const double least = object.name == "hand" ? 4 : 12;
  std::uniform_real_distribution<double> uniform(-1, 1);
  while (true) {
    const auto at = object.query.closest_point(
        object.some_vertex(random) +
        Eigen::Vector3d{uniform(random), uniform(random), uniform(random)});
    if (object.to_border(at.position) < least) continue;
    PressPlace place{at.position, object.normal(at.at.triangle), {}};
    const Eigen::Vector3d any{uniform(random), uniform(random), uniform(random)};
    place.along = (any - any.dot(place.normal) * place.normal).normalized();
    return place;
  }
}

}  // namespace palpate::bench
