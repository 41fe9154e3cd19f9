// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace palpate::probing {

/// A unit in which positions are given by mistake.
struct LengthUnit {
  double mm;
  const char* name;
};

inline constexpr std::array<LengthUnit, 4> kOtherUnits{
    {{1000, "metres"}, {25.4, "inches"}, {10, "centimetres"}, {0.001, "micrometres"}}};

}  // namespace palpate::probing
