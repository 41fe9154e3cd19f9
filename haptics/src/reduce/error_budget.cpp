// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/error_budget.h"

#include <cmath>

#include "palpate/core/require.h"

namespace palpate::haptics {

double ErrorBudget::stated() const {
  double sum = 0;
  for (const double part : {force_noise, position_noise, fit, across, spacing, contrast})
    sum += part * part;
  return std::sqrt(sum);
}

double ErrorBudget::with(const SurfaceErrors& errors) const {
  const auto part = [](const char* name, const std::optional<double>& size, double per_mm) {
    require(name, size, at_least(0).finite(), "mm");
    return size.value_or(0) * per_mm;
  };
  return std::hypot(std::hypot(stated(), part("depth_noise", errors.depth_noise, per_depth_noise)),
                    part("depth_offset", errors.depth_offset, per_depth_offset),
                    part("registration", errors.registration, per_registration));
}

}  // namespace palpate::haptics
