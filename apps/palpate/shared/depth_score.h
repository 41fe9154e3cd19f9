// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/geometry/range_map_score.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The figures of a score, with the names of `RangeMapScore`; lengths in mm.
[[nodiscard]] Json score_figures(const geometry::RangeMapScore& score);

/// The same in words: coverage, wrong depths, errors. `measurable` describes the counted pixels.
[[nodiscard]] std::string score_prose(const geometry::RangeMapScore& score,
                                      const std::string& measurable);

}  // namespace palpate::apps
