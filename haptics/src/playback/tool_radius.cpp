// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/tool_radius.h"

#include <cmath>

#include "palpate/core/require.h"

namespace palpate::haptics {

double missing_force(double probe_radius, double tool_radius) {
  require("missing_force(): probe_radius", probe_radius, above(0).finite(), "mm");
  require("missing_force(): tool_radius", tool_radius, above(0).finite(), "mm");
  return std::sqrt(tool_radius / probe_radius) - 1;
}

}  // namespace palpate::haptics
