// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {

/// A place on the undeformed surface where the tool touches the object.
struct TouchPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< outward unit normal of the surface there
  geometry::SurfacePoint at;                           ///< the same place as a surface point
};

/// The start of the search for the end of a slip: how the last slip ended.
struct SlipMemory {
  double slope = 0;  ///< [N/mm] of |f_T| - mu f_N along the section; 0: none
  /// [N/mm] Derivative of f_T beyond the friction cone by the contact, perpendicular to the
  /// friction axis. Zero: the slip ended along the section.
  Eigen::Matrix3d in_plane = Eigen::Matrix3d::Zero();
};

/// Finds where a slipping contact moves to (thesis 5.4.2).
///
/// The contact moves along the line in which the plane of tool and friction axis cuts the surface
/// (Eq 5.19), from its place (t = 0) at most to where the friction axis through the tool meets the
/// surface (t = 1), and stops at the minimum of h(t) = (|f_T| - mu f_N)^2 (Eq 5.18 with the norm),
/// found by Brent's method with a bounded number of evaluations. The new contact is projected onto
/// the surface. Real-time safe.
/// \param normals normals of the surface's triangles, 3 x T.
[[nodiscard]] TouchPoint slip_contact(const BlendedField& field, const Eigen::Matrix3Xd& normals,
                                      const TouchPoint& contact,
                                      const Eigen::Vector3d& tool) noexcept;

/// Finds where a slipping contact moves to by the rule of Mahvash and Hayward (thesis 5.4.2, Figure
/// 5.6b): the friction boundary of the old contact slides to the tool.
///
/// On the line from the friction axis to the displacement, perpendicular to the axis, the boundary
/// is where |f_T| = mu f_N at the old contact. The contact moves by the rest of that line,
/// projected onto the surface. Changes of field, friction and axis on the way are ignored.
/// Parameters as `slip_contact`. Real-time safe.
[[nodiscard]] TouchPoint slip_by_boundary(const BlendedField& field,
                                          const Eigen::Matrix3Xd& normals,
                                          const TouchPoint& contact,
                                          const Eigen::Vector3d& tool) noexcept;

}  // namespace palpate::haptics
