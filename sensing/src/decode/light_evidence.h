// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "decode/workspace.h"
#include "palpate/sensing/decode_verdict.h"
#include "setup/carrier.h"

namespace palpate::sensing {

/// Step between the lines of `all` of which about `wanted` are examined.
[[nodiscard]] inline long step_for(long all, long wanted) { return std::max(1L, all / wanted); }

/// Adds the light of the channels.
void add_light(const Workspace& work, DecodeEvidence& evidence);

/// Adds the steps of brightness between the rows of the frame, of the whole frame also at half
/// resolution.
void add_row_steps(const Workspace& work, const Carrier& carrier, DecodeEvidence& evidence);

/// Adds the lit pixels that show a sinusoid across the expected direction, on every `step`-th row
/// of the working image.
/// \param carrier of the expected one [rad/px].
void add_sinusoid_across(const Workspace& work, double carrier, long step,
                         DecodeEvidence& evidence);

}  // namespace palpate::sensing
