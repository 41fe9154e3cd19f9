// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "deformation/deformation_equations.h"
#include "palpate/geometry/deformation_graph.h"

namespace palpate::geometry {

/// A sample of the deformed surface, and the plane that it was attracted to.
struct SeenSample {
  int vertex = 0;
  Eigen::Vector3d place;   ///< [mm]
  Eigen::Vector3d normal;  ///< unit, of the deformed surface, not of the plane
  PlanePair pair;          ///< of weight 0 if it is not seen
  PlanePair intensity;     ///< see `intensity_pairs`
};

/// How far measured planes and intensities, rather than the stiffness of the graph, determine
/// motions along the surface: V numbers in [0, 1], 0 where a piece of surface may slide in itself,
/// as on a plane, a sphere or a cylinder.
///
/// Around each node, all rigid motions of a patch are asked how much they change the distances from
/// the planes (Gelfand and Guibas 2004); that translation along the surface counts which, with the
/// best rotation, changes them least. The number is the weight of this change relative to it and to
/// the stiffness of the links that hold the patch. Noise bends the planes as relief does: the
/// change is that which the surface's own normals show too. The weights of intensities account for
/// their noise.
/// \param places of the nodes, 3 x N [mm]
[[nodiscard]] Eigen::VectorXd determined_along(const DeformationGraph& graph,
                                               const Eigen::Matrix3Xd& places,
                                               std::span<const SeenSample> samples,
                                               double stiffness);

}  // namespace palpate::geometry
