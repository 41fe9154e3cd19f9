// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "palpate/probing/acquisition.h"
#include "palpate/probing/press_series.h"

namespace palpate::probing {

/// The samples from a press of a recording.
struct PressSamples {
  std::vector<Sample> samples;         ///< without ids, contact and group
  std::vector<bool> dragged;           ///< as many: the force was turned
  std::size_t drags_without_base = 0;  ///< left out: no press before them had their normal force
};

/// Makes samples of the pieces of a press. A piece is a drag if its force is turned from that of
/// the first one, and its tip is beside the path of the presses before, both by more than a
/// twentieth: b is its position, and a is interpolated between these presses, where the force along
/// the first one was the same (to `touch_force` [N]). The slide becomes a sample that slipped.
[[nodiscard]] PressSamples samples_of_press(const SeriesPress& press, double touch_force);

}  // namespace palpate::probing
