// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::pictures {

/// Assigns each of `count` cells a colour number below `palette` so that neighbouring cells differ.
/// On a plane or a sphere at most six numbers are needed (smallest last; Matula and Beck 1983).
/// \param triangles 3 x T vertex indices.
/// \param labels V: cell of each vertex, -1 if none, all < count.
[[nodiscard]] std::vector<int> color_cells(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                                           const Eigen::Ref<const Eigen::VectorXi>& labels,
                                           int count, int palette);

}  // namespace palpate::pictures
