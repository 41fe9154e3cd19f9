// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace palpate::geometry {

/// Statistics of a set of errors. If the set is empty, the count is 0 and all others are NaN.
struct ErrorStatistics {
  long count = 0;
  double rms = 0;     ///< square root of the mean square
  double median = 0;  ///< of the absolute values
  double p90 = 0;     ///< 90 % quantile of the absolute values
  double p95 = 0;     ///< 95 % quantile of the absolute values
  double max = 0;     ///< of the absolute values
};

/// Statistics of the finite values among `errors`, in their unit.
[[nodiscard]] ErrorStatistics error_statistics(std::vector<double> errors);

}  // namespace palpate::geometry
