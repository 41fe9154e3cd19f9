// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::geometry {

/// The rotation R nearest to a matrix M, which maximises trace(R^T M). For M = U S V^T it is U V^T,
/// with the direction of the smallest singular value reversed if that would be a reflection.
[[nodiscard]] Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

}  // namespace palpate::geometry
