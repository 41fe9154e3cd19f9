// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "base/numbers.h"
#include "geodesic/flat_triangles.h"
#include "geodesic/geodesic_methods.h"
#include "geodesic/window_propagation.h"

namespace palpate::geometry {

GeodesicDistance exact_geodesic_distance(const TriangleMesh& mesh,
                                         std::span<const SurfacePoint> sources,
                                         const GeodesicOptions& options) {
  const double stop_radius = options.stop_radius;
  const double unit = power_of_two_unit(mesh);
  const FlatTriangles flat = flat_triangles(mesh, unit);
  WindowPropagation propagation(flat, stop_radius * unit);
  for (size_t i = 0; i < sources.size(); ++i) {
    propagation.start(sources[i], static_cast<int>(i));
  }
  propagation.run(options.progress);
  GeodesicDistance geodesic{.distance = Eigen::VectorXd::Constant(mesh.vertices.cols(), kInfinity),
                            .label = Eigen::VectorXi::Constant(mesh.vertices.cols(), kNone)};
  for (int v = 0; v < mesh.vertices.cols(); ++v) {
    const double distance = propagation.distance(v) / unit;
    if (!(distance <= stop_radius) || distance == kInfinity) continue;
    geodesic.distance[v] = distance;
    geodesic.label[v] = propagation.source(v);
  }
  return geodesic;
}

}  // namespace palpate::geometry
