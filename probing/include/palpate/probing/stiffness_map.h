// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/contact_stiffness.h"

namespace palpate::probing {

/// The stiffness along a surface, and where a stiff part below it seems to be.
struct StiffnessMap {
  /// [N/mm] V, at the vertices, and their standard deviations. NaN where no contact is as near as
  /// contacts are to each other: nothing is known there.
  Eigen::VectorXd stiffness, deviation;
  double length = 0;  ///< [mm] over which the stiffness changes
  /// [N/mm] The median of the map, by area: the object, if stiff parts lie below less than half of
  /// it. And its highest value at a contact: beyond the outermost contacts it is a guess.
  double soft = 0, stiff = 0;
  Eigen::Vector3d stiffest = Eigen::Vector3d::Zero();  ///< [mm] the contact with the highest value
  double stiff_deviation = 0;                          ///< [N/mm] at that contact
  double threshold = 0;                                ///< [N/mm] midway between soft and stiff
  /// Whether stiff - soft is at least three times `stiff_deviation`. If not, the map shows nothing
  /// but noise, and the contour none either.
  bool distinct = false;
  double area = 0;           ///< [mm^2] of the surface above the threshold
  Eigen::Matrix3Xd contour;  ///< 3 x 2N [mm]: N segments around it, along the surface
};

/// Kriges the stiffness of contacts along a surface (`StiffnessProcess`). The contour is that of
/// what the tip feels, which is blunter and wider than a deep part, and says nothing of its depth.
/// \throws InvalidInput as `StiffnessProcess`, if the mesh is not valid, or no vertex is near a
/// contact.
[[nodiscard]] StiffnessMap stiffness_map(const geometry::TriangleMesh& surface,
                                         std::span<const ContactStiffness> contacts);

}  // namespace palpate::probing
