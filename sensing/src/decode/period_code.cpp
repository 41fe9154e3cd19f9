// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/period_code.h"

#include <cmath>

#include "image/hue.h"
#include "palpate/sensing/gray_code.h"

namespace palpate::sensing {
namespace {

/// A bit this near to its threshold, relative to the sinusoid's amplitude, may be at its edge.
constexpr float kUncertainBit = 0.5F;
/// Share of a period by which a phase may lie beyond its cell. Its ratio to half a period is the
/// share of the pixels with a misread bit that agree by chance.
constexpr double kBeyondCell = 1.0 / 64;

}  // namespace

PeriodCode::PeriodCode(const Pattern& pattern) {
  const Multishot& shots = *pattern.multishot;
  cell_ = kFullTurn * shots.code_cell / pattern.period;
  first_ = kFullTurn * shots.code_start / pattern.period + pattern.phase + cell_ / 2;
  limit_ = cell_ / 2 + kBeyondCell * kFullTurn;
}

std::optional<double> PeriodCode::absolute(double wrapped, const CodeReading& reading) const {
  std::optional<double> best;
  double least = limit_;
  const auto attempt = [&](unsigned code) {
    const double middle = first_ + cell_ * number_of_gray_code(code);
    const double phase = wrapped + kFullTurn * std::round((middle - wrapped) / kFullTurn);
    if (!(std::abs(phase - middle) < least)) return;
    least = std::abs(phase - middle);
    best = phase;
  };
  attempt(reading.code);
  if (reading.margin < kUncertainBit) attempt(reading.code ^ (1U << reading.weakest));
  return best;
}

}  // namespace palpate::sensing
