// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "contacts/intrinsic_triangulation.h"

namespace palpate::geometry {

/// Pins vertices of the border so that the polygons through them approximate it: each polygon edge
/// is at most about `spacing` long (the value of its border half-edge's triangle, in the unit of
/// `positions`), and no border vertex is farther from it than a tenth of that, as in Douglas and
/// Peucker (1973). A loop has at least three pinned vertices.
/// \param positions 3 x ids.
/// \param pinned one entry per id; vertices already pinned count.
void pin_border(const IntrinsicTriangulation& surface, const Eigen::Matrix3Xd& positions,
                const std::vector<double>& spacing_of_triangle, std::vector<char>& pinned);

}  // namespace palpate::geometry
