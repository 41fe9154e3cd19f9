// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::geometry {

/// A neighbouring triangle across each edge, 3 x T; row k belongs to the edge from corner k to
/// corner (k + 1) % 3. -1 at the border. Unlike `opposite_half_edges` it accepts any mesh:
/// orientation is ignored, and where more than two triangles meet, each names the next one by
/// index, cyclically.
[[nodiscard]] Eigen::Matrix3Xi triangle_neighbours(const Eigen::Matrix3Xi& triangles);

}  // namespace palpate::geometry
