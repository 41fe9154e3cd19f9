// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "background.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::pictures {
namespace {

/// Of the depths at each end that may be wrong.
constexpr double kTail = 0.005;
constexpr int kBins = 64;
/// An interval with less of all depths per bin is nearly empty.
constexpr double kStray = 0.0005;
/// Of the bins that have to be empty.
constexpr int kLeastGap = kBins / 4;
/// Of the depths that an object has at least.
constexpr double kLeastObject = 0.02;

}  // namespace

std::optional<double> background_border(const std::vector<double>& depths) {
  if (depths.empty()) return {};
  std::vector<double> sorted = depths;
  std::sort(sorted.begin(), sorted.end());
  const auto count = static_cast<double>(sorted.size());
  const auto tail = static_cast<std::size_t>(kTail * count);
  const double low = sorted[tail];
  const double high = sorted[sorted.size() - 1 - tail];
  if (!(high > low)) return {};
  std::array<double, kBins> filled{};
  for (const double depth : sorted) {
    const double place = std::clamp((depth - low) / (high - low), 0.0, 1.0);
    filled[std::min(static_cast<std::size_t>(place * kBins), std::size_t{kBins - 1})] += 1 / count;
  }
  int begin = 0, longest = 0, run = 0;
  double before = 0, object = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    const double share = filled[static_cast<std::size_t>(bin)];
    run = share < kStray ? run + 1 : 0;
    before += share;
    if (run <= longest) continue;
    longest = run;
    begin = bin + 1 - run;
    object = before;
  }
  if (longest < kLeastGap || object < kLeastObject) return {};
  return low + (high - low) * (begin + longest / 2.0) / kBins;
}

}  // namespace palpate::pictures
