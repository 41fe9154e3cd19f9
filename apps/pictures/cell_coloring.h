// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::pictures {

/// A colour number below `palette` for each of `count` cells so that cells that meet differ.
///
/// `labels` V: cell of each vertex, -1 = none, all < count; `triangles` 3 x T vertex indices. On a
/// plane or a sphere it takes at most six numbers (Matula and Beck 1983: smallest last).
[[nodiscard]] std::vector<int> color_cells(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                                           const Eigen::Ref<const Eigen::VectorXi>& labels,
                                           int count, int palette);

}  // namespace palpate::pictures
