// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "palpate/haptics/reduce_model.h"

namespace palpate::haptics {

/// A reduced model may have an error at least this many times that of the full one: less would
/// leave no room for a difference between them.
inline constexpr double kReductionRoom = 1.1;

/// [N] The error of a model that is asked for, if any. \param force [N] RMS of the forces.
[[nodiscard]] inline std::optional<double> asked_error(const ReduceOptions& options, double force) {
  if (!options.max_error && !options.max_relative_error) return std::nullopt;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  return std::min(options.max_error.value_or(kAny),
                  options.max_relative_error.value_or(kAny) * force);
}

}  // namespace palpate::haptics
