// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate::pictures {

/// [px] of the line at a tick.
inline constexpr double kTickLength = 6;

/// Ticks of a scale: whole multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 0;
  std::vector<double> values;       ///< increasing, within the scale
  std::vector<std::string> labels;  ///< one per tick, all with the same number of decimals
};

/// The largest value <= `length` of the form 1, 2 or 5 times a power of ten; length > 0.
[[nodiscard]] double round_down(double length);

/// Makes at most `most` (>= 2) ticks for the scale from `low` to `high` (low < high).
[[nodiscard]] Ticks make_ticks(double low, double high, int most);

/// Formats `value` with as many decimals as multiples of `step` need.
[[nodiscard]] std::string format_value(double value, double step);

}  // namespace palpate::pictures
