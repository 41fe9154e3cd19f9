// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::geometry {

/// Standard deviation of a normal distribution of which half is within `median` of zero.
[[nodiscard]] inline double deviation_of_median(double median) {
  // Half of a normal distribution lies within 0.6745 deviations, of which this is the inverse.
  constexpr double kDeviationOfMedian = 1.4826;
  return kDeviationOfMedian * median;
}

/// Tukey's weights are zero from this many deviations on.
inline constexpr double kTukeyCutOff = 4.685;

/// Tukey's biweight: 1 at distance 0, 0 from the cut-off on.
/// \param distance >= 0
[[nodiscard]] inline double tukey_weight(double distance, double deviation) {
  const double ratio = distance / (kTukeyCutOff * deviation);
  if (!(ratio < 1)) return 0;
  const double root = 1 - ratio * ratio;
  return root * root;
}

}  // namespace palpate::geometry
