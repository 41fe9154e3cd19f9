// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "contacts/intrinsic_triangulation.h"

namespace palpate::geometry {

/// Removes every vertex that is not pinned (`pinned`: one entry an id), the flattest first, and
/// leaves an intrinsic Delaunay triangulation of the others; removed vertices become tracked
/// points. Before a vertex goes it is flattened: its edges are scaled by one factor, which makes
/// its angles sum up to 2 pi (pi at the border) and moves its curvature to its neighbours (Liu,
/// Gillespie, Chislett, Sharp, Jacobson and Crane 2023). A flat surface keeps its metric. Vertices
/// that cannot be flattened, which is rare, stay.
void coarsen(IntrinsicTriangulation& surface, const std::vector<char>& pinned);

}  // namespace palpate::geometry
