// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/deformed_shape.h"

#include "palpate/geometry/geodesic_distance.h"
#include "palpate/require.h"

namespace palpate::haptics {

Eigen::Matrix3Xd drawn_shape(const geometry::TriangleMesh& surface,
                             const geometry::SurfacePoint& contact,
                             const Eigen::Vector3d& displacement,
                             const DrawnShapeOptions& options) {
  require("DrawnShapeOptions::tip", options.tip, at_least(0).finite(), "mm");
  require("DrawnShapeOptions::reach", options.reach, above(0).finite());
  const double radius = options.tip + options.reach * displacement.norm();
  if (!displacement.allFinite() || displacement.isZero(0)) return surface.vertices;
  const geometry::GeodesicDistance along =
      geometry::geodesic_distance(surface, {&contact, 1}, {.stop_radius = radius});
  Eigen::Matrix3Xd shape = surface.vertices;
  for (Eigen::Index v = 0; v < shape.cols(); ++v) {
    const double s = along.distance[v] / radius;
    if (s < 1) shape.col(v) += (1 - s * s) * (1 - s * s) * displacement;
  }
  return shape;
}

}  // namespace palpate::haptics
