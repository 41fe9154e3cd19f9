// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {

/// A place on the undeformed surface where the tool touches the object.
struct TouchPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< unit, outwards, of the surface there
  geometry::SurfacePoint at;                           ///< the same on the surface
};

/// Where a contact that does not hold slips to (thesis 5.4.2).
///
/// It moves along the line in which the plane of tool and friction axis cuts the surface, Eq 5.19,
/// from where it is (t = 0) at most to where the friction axis through the tool meets the surface
/// (t = 1), to the least h(t) = (|f_T| - mu f_N)^2 (Eq 5.18 with the norm), by Brent's method with
/// a bounded number of evaluations. The new contact is put on the surface by its nearest point.
/// `normals` are those of the surface's triangles, 3 x T. Real-time safe.
[[nodiscard]] TouchPoint slip_contact(const BlendedField& field, const Eigen::Matrix3Xd& normals,
                                      const TouchPoint& contact,
                                      const Eigen::Vector3d& tool) noexcept;

}  // namespace palpate::haptics
