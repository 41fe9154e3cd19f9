// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::geometry {

/// The rotation R that is nearest to a matrix M, by its largest trace(R^T M): of M = U S V^T it is
/// U V^T, with the direction of the least singular value turned round if that were a reflection.
[[nodiscard]] Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

}  // namespace palpate::geometry
