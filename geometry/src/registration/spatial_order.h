// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::geometry {

/// The points along a Morton curve, on which neighbours in the order are near in space: queries of
/// points in this order find most of the surface in the cache. Points in the same of 2^30 cells of
/// the bounding cube keep their order.
/// \param points 3 x N, finite.
[[nodiscard]] Eigen::Matrix3Xd in_spatial_order(const Eigen::Matrix3Xd& points);

}  // namespace palpate::geometry
