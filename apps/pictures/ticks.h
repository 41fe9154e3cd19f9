// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate::pictures {

/// Where a scale is labelled: whole multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 0;
  std::vector<double> values;       ///< increasing, within the scale
  std::vector<std::string> labels;  ///< one each, all with the same number of decimals
};

/// The largest of 1, 2, 5 times a power of ten that is not above `length`; length > 0.
[[nodiscard]] double round_down(double length);

/// The ticks of the scale from `low` to `high` (low < high), at most `most` (>= 2) of them.
[[nodiscard]] Ticks make_ticks(double low, double high, int most);

/// `value` with as many decimals as multiples of `step` need.
[[nodiscard]] std::string format_value(double value, double step);

}  // namespace palpate::pictures
