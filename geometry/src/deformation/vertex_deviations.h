// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "deformation/deformation_equations.h"
#include "palpate/geometry/deformation_graph.h"

namespace palpate::geometry {

/// A solution of the equations, and the data that it was computed from.
struct FittedGraph {
  std::vector<Eigen::Isometry3d> motions;
  double scale = 1;
  bool scale_is_free = false;
  double stiffness = 0;
  double least_noise = 0;  ///< [mm] of a distance; > 0
  double reach = 0;        ///< [mm] deviation of the motion of the surface, before it is measured
  /// One per sample of the equations: first those of measured planes, then those of intensities,
  /// then those without errors.
  std::vector<PlanePair> pairs;
  std::size_t planes = 0;    ///< number of `pairs` that are planes
  std::size_t measured = 0;  ///< number of `pairs` that have errors
  /// [px] of the intensities, as `BlurredImages::pixel_of`
  std::vector<Eigen::Vector2d> pixels = {};
};

/// Standard deviations of the places of vertices, V each [mm]; NaN in pieces of surface of which
/// nothing is measured, and for vertices without triangles.
struct VertexDeviations {
  Eigen::VectorXd across;  ///< along the normal
  Eigen::VectorXd along;   ///< root mean square length of the error in the tangent plane
};

/// Propagates four independent errors through the equations:
/// - of each measurement. All of a kind have the variance that their distances show. Those of
///   planes are independent, those of intensities are alike within the blur of the image.
/// - of the links: random fields of strain, from two spacings of the nodes to the extent of the
///   surface. Their variance is that which the links of the solution show beyond the errors of
///   measurements, so it is large where the measurements hardly show strain.
/// - of the scale, which the equations pull to 1.
/// - of the motion of the whole surface, which is `reach` where nothing shows it.
/// Noise turns the planes of single pixels as relief does, and would seem to show motions along the
/// surface. The sensitivity of the equations is therefore that to mean planes around nodes, of
/// which the noise is removed.
/// \param equations of the graph; they are linearised
[[nodiscard]] VertexDeviations vertex_deviations(const DeformationGraph& graph,
                                                 DeformationEquations& equations,
                                                 const FittedGraph& fitted);

}  // namespace palpate::geometry
