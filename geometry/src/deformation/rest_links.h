// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "palpate/geometry/deformation_graph.h"

namespace palpate::geometry {

/// The links of a graph at rest, 3 x E [mm], as they lie in the undeformed surface: s l (g_k - g_j)
/// with the scale s of the whole surface. l is the length of the link relative to that of the mean
/// of R_j (g_k - g_j) and R_k (g_k - g_j), which enclose an angle where the surface bends. Without
/// it, bending would shrink the surface.
[[nodiscard]] Eigen::Matrix3Xd rest_links(const DeformationGraph& graph,
                                          std::span<const Eigen::Isometry3d> motions, double scale);

}  // namespace palpate::geometry
