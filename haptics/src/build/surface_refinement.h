// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Splits edges of a model's surface that are too long for the weights of contacts, which are
/// linear along edges. At a contact an edge is at most two thirds of the distance to the nearest
/// other contact on the same side of the object; further away from contacts it may be longer. The
/// shape of the surface stays.
struct RefinedSurface {
  Eigen::Matrix2Xi ends;                       ///< of what was split, as in `geometry::SplitMesh`
  std::vector<geometry::SurfacePoint> places;  ///< of the contacts, on the refined surface
};
/// \param directions 3 x N, into the object at the contacts
RefinedSurface refine_surface(const Eigen::Matrix3Xd& directions, Model& model);

}  // namespace palpate::haptics
