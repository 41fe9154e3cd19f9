// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/error_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::geometry {
namespace {

/// Quantile of sorted values, interpolated linearly.
double interpolated_quantile(const std::vector<double>& sorted, double fraction) {
  const double place = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double t = place - static_cast<double>(below);
  return (1 - t) * sorted[below] + t * sorted[above];
}

}  // namespace

ErrorStatistics error_statistics(std::vector<double> errors) {
  std::erase_if(errors, [](double e) { return !std::isfinite(e); });
  if (errors.empty()) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {.count = 0, .rms = nan, .median = nan, .p90 = nan, .p95 = nan, .max = nan};
  }
  for (double& e : errors) e = std::abs(e);
  std::sort(errors.begin(),
            errors.end());  // sort before summing, so that the order of the errors does not matter
  double sum_of_squares = 0;
  for (const double e : errors) sum_of_squares += e * e;
  return {.count = static_cast<long>(errors.size()),
          .rms = std::sqrt(sum_of_squares / static_cast<double>(errors.size())),
          .median = interpolated_quantile(errors, 0.5),
          .p90 = interpolated_quantile(errors, 0.9),
          .p95 = interpolated_quantile(errors, 0.95),
          .max = errors.back()};
}

}  // namespace palpate::geometry
