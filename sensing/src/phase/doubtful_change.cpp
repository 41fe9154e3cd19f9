// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/doubtful_change.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/hot_loop.h"
#include "palpate/core/quantile.h"

namespace palpate::sensing {
namespace {

/// The typical change is the median of one pixel in this many. No factor of usual widths of images,
/// so that the pixels are spread over the columns.
constexpr long kSampleStep = 7;

PALPATE_HOT_LOOP void add_doubt_of(const float* change, float per_doubt, float unknown,
                                   float* __restrict doubt, long pixels) {
  for (long i = 0; i < pixels; ++i) {
    const float part = change[i] * per_doubt;
    const float square = part * part;
    doubt[i] += square == square ? square : unknown;
  }
}

}  // namespace

float doubtful_change(const Plane& changes, const DoubtfulChange& limits) {
  std::vector<float> sizes;
  for (long i = 0; i < changes.size(); i += kSampleStep) {
    const float size = std::abs(changes.data()[i]);
    if (!std::isnan(size)) sizes.push_back(size);
  }
  if (sizes.empty()) return static_cast<float>(limits.most);
  const double rare = limits.typicals * static_cast<double>(median(sizes));
  return static_cast<float>(std::clamp(rare, limits.least, limits.most));
}

void add_doubt(const Plane& changes, float doubtful, float unknown, Plane& doubt) {
  add_doubt_of(changes.data(), 1 / doubtful, unknown, doubt.data(), doubt.size());
}

}  // namespace palpate::sensing
