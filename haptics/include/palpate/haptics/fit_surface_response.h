// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The surface as it was recorded while the tool held a contact displaced.
struct RecordedShape {
  std::size_t contact = 0;                                 ///< index in `Model::contacts`
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm] of the contact, in the world
  /// [mm] 3 x V: positions of the vertices of the model's surface; those that a camera did not see
  /// must be filled in, as `palpate track` does.
  Eigen::Matrix3Xd vertices;
};

struct SurfaceResponseOptions {
  /// Nodes of the surface, in [1, 65535]; at most one a vertex. A model takes 18 bytes for each
  /// node and contact.
  int nodes = 200;
};

/// Learns how the surface follows the tool (`SurfaceResponse`). At each contact, the dent k(d)
/// minimises the sum of squares, over all shapes, of the remaining motion of the vertices along
/// delta; it reaches two distances between contacts. Then B_n of node n minimises
///
///     sum_k |u_nk - B_n delta_k|^2 + p sum_k |delta_k|^2 |B_n - b_n I|^2
///
/// over the shapes k of the contact, with the motion u_nk of the node beside the dent, the
/// displacement delta_k, p = 1e-3, and the scalar b_n that fits best: it decides along directions
/// without any displacement. The result states its errors at all vertices of all shapes.
/// \param shape the k-th of `count` recorded shapes; each is requested twice, so that not all must
/// be in memory. A shape without displacement contributes only to the error.
/// \throws InvalidInput if `count` is 0, a shape has another number of vertices, a contact that
/// does not exist or a number that is not finite (naming the shape), if no shape is displaced, or
/// an option is outside its range. Exceptions of `shape` pass through.
[[nodiscard]] SurfaceResponse fit_surface_response(
    const Model& model, std::size_t count, const std::function<RecordedShape(std::size_t)>& shape,
    const SurfaceResponseOptions& options = {});

}  // namespace palpate::haptics
