// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "range_sequence.h"
#include "view.h"

namespace palpate::view {

/// Range maps that were found, and how they are shown first.
struct RangeScene {
  std::string name;
  RangeSequence sequence;
  MapLayer layer = MapLayer::depth;
  bool as_surface = false;
  bool still = false;  ///< only pictures are wanted: a map that cannot be read ends the program
};

/// A sequence of range maps as images or as surfaces in false colour.
[[nodiscard]] std::unique_ptr<View> make_range_view(RangeScene scene);

}  // namespace palpate::view
