// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace palpate::geometry {

/// The least of the values that a fraction of them does not exceed: one of them, not a value in
/// between. Pre: there are values, none is NaN.
[[nodiscard]] double rank_quantile(const auto& values, double fraction) {
  std::vector<double> sorted(values.begin(), values.end());
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(fraction * static_cast<double>(sorted.size())) - 1);
  const auto place = sorted.begin() + std::max<std::ptrdiff_t>(rank, 0);
  std::nth_element(sorted.begin(), place, sorted.end());
  return *place;
}

}  // namespace palpate::geometry
