// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// [0, 1] Share of the surface around each place that faces a direction d: the share of the area of
/// triangles whose normal n has n . d > 0, among those at the place and at all vertices within
/// `radius` of it that are connected with it inside that ball. A triangle counts once for each of
/// these vertices. Unlike the normal of the triangle at the place, the share hardly depends on a
/// single sliver that faces anywhere.
///
/// NaN where no triangle has an area that faces or turns away from d, or d is not finite.
/// \param directions 3 x N, any length, in the frame of the mesh.
/// \param radius [mm] >= 0.
/// \throws InvalidInput if the mesh, a place or the radius is not valid, or unless there are as
/// many directions as places.
[[nodiscard]] Eigen::VectorXd facing_shares(const TriangleMesh& mesh,
                                            std::span<const SurfacePoint> places,
                                            const Eigen::Ref<const Eigen::Matrix3Xd>& directions,
                                            double radius);

}  // namespace palpate::geometry
