// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/bounding_tree.h"

namespace palpate::geometry {

/// Builds a tree without Embree, in less time, for queries that take longer: the cubes of a Morton
/// curve are halved until 32 triangles are left, and these at their medians.
/// \param vertices 3 x V, local frame.
/// \param margin by which boxes are enlarged on all sides.
[[nodiscard]] BoundingTree build_quick_tree(const Eigen::Matrix3Xd& vertices,
                                            const Eigen::Matrix3Xi& triangles, double margin);

}  // namespace palpate::geometry
