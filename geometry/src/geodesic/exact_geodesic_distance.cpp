// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "base/numbers.h"
#include "geodesic/geodesic_methods.h"
#include "geodesic/geodesic_surface_data.h"
#include "geodesic/window_propagation.h"

namespace palpate::geometry {

GeodesicDistance exact_geodesic_distance(const GeodesicSurface& surface,
                                         std::span<const SurfacePoint> sources,
                                         const GeodesicOptions& options) {
  const double stop_radius = options.stop_radius;
  const FlatTriangles& flat = surface.impl().flat();
  const double unit = flat.unit;
  WindowPropagation propagation(flat, stop_radius * unit);
  for (size_t i = 0; i < sources.size(); ++i) {
    propagation.start(sources[i], static_cast<int>(i));
  }
  propagation.run(options.progress);
  const Eigen::Index count = surface.mesh().vertices.cols();
  GeodesicDistance geodesic{.distance = Eigen::VectorXd::Constant(count, kInfinity),
                            .label = Eigen::VectorXi::Constant(count, kNone)};
  for (int v = 0; v < count; ++v) {
    const double distance = propagation.distance(v) / unit;
    if (!(distance <= stop_radius) || distance == kInfinity) continue;
    geodesic.distance[v] = distance;
    geodesic.label[v] = propagation.source(v);
  }
  return geodesic;
}

}  // namespace palpate::geometry
