// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace palpate::geometry {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Stands for a missing index.
inline constexpr int kNone = -1;

/// The smallest of the values that is >= the given fraction of them; not interpolated.
/// Precondition: there are values, none of them NaN.
[[nodiscard]] double rank_quantile(const auto& values, double fraction) {
  std::vector<double> sorted(values.begin(), values.end());
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(fraction * static_cast<double>(sorted.size())) - 1);
  const auto place = sorted.begin() + std::max<std::ptrdiff_t>(rank, 0);
  std::nth_element(sorted.begin(), place, sorted.end());
  return *place;
}

}  // namespace palpate::geometry
