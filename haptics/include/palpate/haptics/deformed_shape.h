// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::haptics {

struct DrawnShapeOptions {
  /// [mm] >= 0 along the surface that follows the contact, as if under the tip.
  double tip = 3;
  double reach = 3;  ///< > 0, of the dent beyond the tip, in lengths of the displacement
};

/// The surface with one contact displaced, for pictures: DRAWN, NOT MEASURED. Each vertex moves by
/// the displacement times a smooth function of its distance d along the surface to the contact,
/// which is 1 at the contact and 0 from `tip + reach |displacement|` on:
///
///     (1 - s^2)^2    with s = d / (tip + reach |displacement|)
///
/// The shape is continuous in contact and displacement. Forces do not depend on it.
/// \param surface undeformed, V vertices. \param contact on it. \param displacement [mm] world
/// \return 3 x V [mm]; the undeformed vertices for a displacement that is zero or not finite.
/// \throws InvalidInput if the mesh is not valid, the contact is not on it, or on an option outside
/// its range.
[[nodiscard]] Eigen::Matrix3Xd drawn_shape(const geometry::TriangleMesh& surface,
                                           const geometry::SurfacePoint& contact,
                                           const Eigen::Vector3d& displacement,
                                           const DrawnShapeOptions& options = {});

}  // namespace palpate::haptics
