// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "depth_span.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate::pictures {
namespace {

/// Of the depths at each end that the colours need not tell apart.
constexpr double kDepthTail = 0.005;

/// A map is at one depth throughout if its depths span less than this fraction of it: ticks could
/// not be told apart by their numbers.
constexpr double kFlat = 1e-6;

/// [mm] half of the scale of such a map.
constexpr double kFlatHalfScale = 0.5;

}  // namespace

DepthSpan depth_span(std::vector<double> depths) {
  const auto tail = static_cast<std::ptrdiff_t>(kDepthTail * static_cast<double>(depths.size()));
  const auto near = depths.begin() + tail;
  const auto far = depths.end() - 1 - tail;
  std::nth_element(depths.begin(), near, depths.end());
  const double low = *near;
  std::nth_element(depths.begin(), far, depths.end());
  const double high = *far;
  const double middle = (low + high) / 2;
  if (high - low < kFlat * std::abs(middle))
    return {middle - kFlatHalfScale, middle + kFlatHalfScale};
  return {low, high};
}

}  // namespace palpate::pictures
