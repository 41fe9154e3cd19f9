// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "ticks.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace palpate::pictures {
namespace {

/// A tick this near the end of the scale, in steps, still belongs to it: rounding of low / step.
constexpr double kEndSlack = 1e-9;

/// The widest number that is written out; beyond, and for steps below its inverse, powers of ten.
constexpr double kWidest = 1e6;

/// More than the largest ratio of neighbours in 1, 2, 5, 10 (2.5), less than the least of two (4).
constexpr double kBetweenSteps = 2.6;

/// 1, 2, 5, 10, 20, ...: the one after `step`.
double next_step(double step) { return round_down(step * kBetweenSteps); }

}  // namespace

double round_down(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= length) {
      return factor * power;
    }
  }
  return power;
}

std::string format_value(double value, double step) {
  std::ostringstream text;
  if (std::abs(value) >= kWidest || step < 1 / kWidest) {
    text << std::setprecision(4) << value;
    return text.str();
  }
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + kEndSlack)));
  // Not "-0.0".
  const double shown = std::abs(value) < 0.5 * std::pow(10.0, -decimals) ? 0.0 : value;
  text << std::fixed << std::setprecision(decimals) << shown;
  return text.str();
}

Ticks make_ticks(double low, double high, int most) {
  const double least_step = (high - low) / (most - 1);
  Ticks ticks;
  ticks.step = round_down(least_step);
  while (ticks.step < least_step) {
    ticks.step = next_step(ticks.step);
  }
  const double first = std::ceil(low / ticks.step - kEndSlack);
  const double last = std::floor(high / ticks.step + kEndSlack);
  for (double count = first; count <= last; ++count) {
    ticks.values.push_back(count * ticks.step);
    ticks.labels.push_back(format_value(ticks.values.back(), ticks.step));
  }
  return ticks;
}

}  // namespace palpate::pictures
