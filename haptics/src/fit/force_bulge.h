// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// How many times as large as the largest force of the pairs, 3 x N each and not all zero, a field
/// that was fitted to them gets on the straight ways from rest to their displacements; at least 1.
/// Bases of both signs can explain a few noisy pairs by a bump of force where nothing was measured.
/// A certificate of passivity allows that: it only forbids to gain energy.
[[nodiscard]] double force_bulge(const ForceField& field,
                                 const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                 const Eigen::Ref<const Eigen::Matrix3Xd>& forces);

}  // namespace palpate::haptics
