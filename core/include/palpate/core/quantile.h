// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace palpate {

/// The smallest of the values below or at which `fraction` of them lie; not interpolated.
/// Precondition: there are values, and none is NaN.
/// \param values a vector of the standard library or of Eigen.
[[nodiscard]] auto quantile(const auto& values, double fraction) {
  std::vector sorted(values.begin(), values.end());
  const double rank = std::ceil(fraction * static_cast<double>(sorted.size())) - 1;
  const auto place = sorted.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 0.0));
  std::nth_element(sorted.begin(), place, sorted.end());
  return *place;
}

/// Median; of an even number of values the upper of the two middle ones.
/// Precondition: as of `quantile`.
[[nodiscard]] auto median(const auto& values) {
  std::vector sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace palpate
