// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace palpate::geometry {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Stands for a missing index.
inline constexpr int kNone = -1;

}  // namespace palpate::geometry
