// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/hue.h"

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

PALPATE_HOT_LOOP void find_hues_of(const float* red, const float* green, const float* blue,
                                   float* hue, long count) {
  for (long i = 0; i < count; ++i) hue[i] = hue_of(red[i], green[i], blue[i]).angle;
}

}  // namespace

void find_hues(const Plane& red, const Plane& green, const Plane& blue, Plane& hue) {
  hue.resize(red.rows(), red.cols());
  find_hues_of(red.data(), green.data(), blue.data(), hue.data(), hue.size());
}

}  // namespace palpate::sensing
