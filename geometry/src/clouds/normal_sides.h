// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "clouds/point_tree.h"

namespace palpate::geometry {

/// Turns normals (3 x N, NaN where unknown) to the same side as their neighbours', and those of
/// each connected part outwards: see `cloud_normals`.
/// \param steps counts the points.
void turn_to_one_side(const PointTree& tree, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      int neighbours, Eigen::Matrix3Xd& normals, WorkSteps& steps);

}  // namespace palpate::geometry
