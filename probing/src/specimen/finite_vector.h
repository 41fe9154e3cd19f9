// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string_view>

#include "palpate/core/require.h"

namespace palpate::probing {

/// \throws InvalidInput naming the argument, unless all components are finite.
inline void require_finite(std::string_view name, const Eigen::Vector3d& vector,
                           std::string_view unit) {
  for (const double component : vector) require(name, component, finite(), unit);
}

}  // namespace palpate::probing
