// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace palpate::sensing {

/// A linear function of the light: constant + slope * light, both >= 0.
struct LinearInLight {
  double constant = 0;
  double slope = 0;
};

/// A value of places of similar light.
struct LightGroup {
  double light = 0;
  double value = 0;
};

/// Least squares of the relative deviations; a term that would become negative is left out, as are
/// values that are not > 0.
[[nodiscard]] LinearInLight fit_light(const std::vector<LightGroup>& groups);

/// The largest number of groups, and the smallest number of samples in each.
inline constexpr std::size_t kLightGroups = 8;
inline constexpr std::size_t kLeastInGroup = 50;

/// Sorts samples by their `light` and divides them into groups of equal size.
/// \param count of the groups; no more than there are samples.
template <typename Sample>
[[nodiscard]] std::vector<std::span<Sample>> light_groups(std::vector<Sample>& samples,
                                                          std::size_t count) {
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.light < b.light; });
  std::vector<std::span<Sample>> groups;
  for (std::size_t group = 0; group < count; ++group) {
    const std::size_t first = group * samples.size() / count;
    const std::size_t last = (group + 1) * samples.size() / count;
    groups.push_back(std::span(samples).subspan(first, last - first));
  }
  return groups;
}

/// The median of a member over a group; changes the order of its samples.
template <typename Sample>
[[nodiscard]] double median_of(std::span<Sample> group, float Sample::*value) {
  const auto middle = group.begin() + static_cast<std::ptrdiff_t>(group.size() / 2);
  std::nth_element(group.begin(), middle, group.end(),
                   [=](const Sample& a, const Sample& b) { return a.*value < b.*value; });
  return static_cast<double>((*middle).*value);
}

}  // namespace palpate::sensing
