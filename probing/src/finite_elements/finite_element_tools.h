// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "finite_elements/quadratic_tetrahedron.h"
#include "palpate/probing/finite_element_mesh.h"

namespace palpate::probing {

// Adds nodes in the middle of the edges, and turns tetrahedra of negative volume.
[[nodiscard]] FiniteElementMesh with_middle_nodes(
    const Eigen::Matrix3Xd& corners, const std::vector<std::array<int, 4>>& tetrahedra);

[[nodiscard]] ElementNodes element_nodes(const FiniteElementMesh& mesh,
                                         const Eigen::Matrix3Xd& positions, Eigen::Index element);

}  // namespace palpate::probing
