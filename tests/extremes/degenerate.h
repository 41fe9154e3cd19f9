// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "input.h"

namespace palpate::extremes {

/// An input that nobody wants and somebody has.
struct Degenerate {
  std::string name;
  unsigned parts = 0;  ///< of the input that it changes: `Part`
  std::function<void(Input&)> spoil;
};

/// The catalogue. Each is valid input, or is refused.
[[nodiscard]] const std::vector<Degenerate>& degenerate_inputs();

}  // namespace palpate::extremes
