// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

namespace palpate::extremes {

/// What the standard input has many of.
struct Element {
  std::string_view name;
  double count = 0;  ///< in the standard input
  /// As many more as the input is wider; else as its area is larger.
  bool along = false;
};

/// How the cost of an operation grows with the size of its input, as stated.
struct Growth {
  std::string_view operation;
  Element element;  ///< of which there are more
  /// Widths between which it is measured, as multiples of the standard input's.
  int from = 2, to = 8;
  /// Processor time grows at most with this power of the number of elements.
  double exponent = 0;
  /// [bytes] of memory at most that each further element takes, beside the input.
  double bytes = 0;
  /// Takes so long that only the large size of the suite has it.
  bool only_large = false;
};

/// One for each operation with an input that can be made larger.
[[nodiscard]] const std::vector<Growth>& stated_growth();

/// [1] Number of elements of an input of a width.
[[nodiscard]] double elements_of(const Element& element, int extent);

}  // namespace palpate::extremes
