// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "contacts/intrinsic_triangulation.h"

namespace palpate::geometry {

/// Pins vertices of the border so that the polygons through them stand for it: each edge is at most
/// about `spacing` long (of its half-edge at the border, in the unit of `positions`) and no vertex
/// is further from it than a tenth of that, as in the simplification of Douglas and Peucker (1973);
/// a loop has at least three. `positions`: 3 x ids; `pinned`: one entry an id, those that are
/// pinned already count.
void pin_border(const IntrinsicTriangulation& surface, const Eigen::Matrix3Xd& positions,
                const std::vector<double>& spacing_of_triangle, std::vector<char>& pinned);

}  // namespace palpate::geometry
