// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "palpate/sensing/pattern.h"

namespace palpate::sensing {

/// The bits of the code that a pixel shows.
struct CodeReading {
  unsigned code = 0;
  int weakest = 0;  ///< the bit nearest to the threshold between dark and bright
  /// Its distance from there, relative to the sinusoid's amplitude.
  float margin = std::numeric_limits<float>::infinity();

  /// Adds the next lower bit.
  /// \param bits number of bits that are still lower
  void append(float value, int bits) {
    code = 2 * code + (value > 0 ? 1U : 0U);
    const float distance = value < 0 ? -value : value;
    if (!(distance < margin)) return;
    margin = distance;
    weakest = bits;
  }
};

/// Multiples of 2 pi from a phase and a code.
class PeriodCode {
 public:
  /// \param pattern with `multishot`
  explicit PeriodCode(const Pattern& pattern);
  /// The absolute phase 2 pi pixel / period + phase that equals `wrapped` [rad] up to turns; empty
  /// if the code contradicts it.
  [[nodiscard]] std::optional<double> absolute(double wrapped, const CodeReading& reading) const;

 private:
  double first_;  ///< [rad] phase in the middle of cell 0
  double cell_;   ///< [rad] width of a cell
  double limit_;  ///< [rad] largest distance from the middle of its cell at which a phase agrees
};

}  // namespace palpate::sensing
