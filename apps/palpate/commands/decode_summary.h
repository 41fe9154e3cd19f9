// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/reason.h"

namespace palpate::apps {

/// "1234 reconstructed, 56 unlit, ..."
[[nodiscard]] std::string counts(const sensing::ReasonImage& reasons);

/// [mm] Median of the known depths; NaN if there is none.
[[nodiscard]] double median_depth(const geometry::ImageF& z);

}  // namespace palpate::apps
