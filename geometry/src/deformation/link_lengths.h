// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "palpate/geometry/deformation_graph.h"

namespace palpate::geometry {

/// How long each link of a graph is at rest, relative to its length in the undeformed surface (E
/// numbers): its chord g'_k - g'_j relative to the mean projection of that on R_j (g_k - g_j) and
/// R_k (g_k - g_j). Where a surface bends, these enclose an angle, and their mean is shorter than
/// the link: without this, bending would shrink the surface.
[[nodiscard]] Eigen::VectorXd link_lengths(const DeformationGraph& graph,
                                           std::span<const Eigen::Isometry3d> motions);

}  // namespace palpate::geometry
