// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Ratio of the largest force of a fitted field, on the straight lines from rest to the
/// displacements, to that of the pairs, 3 x N each and not all zero; at least 1. Bases of both
/// signs can explain a few noisy pairs by a bump of force where nothing was measured. A certificate
/// of passivity allows this: it only forbids a gain of energy.
[[nodiscard]] double force_bulge(const ForceField& field,
                                 const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                 const Eigen::Ref<const Eigen::Matrix3Xd>& forces);

}  // namespace palpate::haptics
