// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field_fit.h"

namespace palpate::haptics {

/// `fit_force_field` that stays `convex` where noise does not explain the errors: for pairs that
/// are computed, and for trials, which have to be quick.
[[nodiscard]] FitResult fit_steadily(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                     const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                     const FitOptions& options);

}  // namespace palpate::haptics
