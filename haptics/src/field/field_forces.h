// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// `force` at each displacement, to the bit, in half of its time: what a base does at zero is
/// computed once.
[[nodiscard]] Eigen::Matrix3Xd field_forces(const ForceField& field,
                                            const Eigen::Matrix3Xd& displacements);

}  // namespace palpate::haptics
