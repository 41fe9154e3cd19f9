// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bindings.h"
#include "palpate/haptics/trajectory_csv.h"

namespace palpate::python {

/// The trace of a tool along its path.
struct Trace {
  std::vector<haptics::TracePoint> points;
};

/// Positions (N, 3) [mm] at the times (N,) [s], or at 1 kHz for None. \throws InvalidInput
[[nodiscard]] std::vector<haptics::TrajectoryPoint> trajectory(const py::object& tools,
                                                               const py::object& times);

}  // namespace palpate::python
