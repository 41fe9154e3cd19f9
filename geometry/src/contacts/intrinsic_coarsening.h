// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "contacts/intrinsic_triangulation.h"
#include "palpate/core/work_steps.h"

namespace palpate::geometry {

/// Removes every vertex that is not pinned, the flattest first, and leaves an intrinsic Delaunay
/// triangulation of the others; removed vertices become tracked points.
///
/// A vertex is flattened before removal: its edges are scaled by one factor that makes its angles
/// sum to 2 pi (pi at the border), which moves its curvature to its neighbours (Liu, Gillespie,
/// Chislett, Sharp, Jacobson and Crane 2023). A flat surface keeps its metric. Vertices that cannot
/// be flattened, which is rare, stay.
/// \param pinned one entry per id.
/// \param steps counts the vertices removed.
void coarsen(IntrinsicTriangulation& surface, const std::vector<char>& pinned, WorkSteps& steps);

}  // namespace palpate::geometry
