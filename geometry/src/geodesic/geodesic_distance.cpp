// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_distance.h"

#include <string>

#include "geodesic/geodesic_methods.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::geometry {

GeodesicDistance geodesic_distance(const GeodesicSurface& surface,
                                   std::span<const SurfacePoint> sources,
                                   const GeodesicOptions& options) {
  require("GeodesicOptions::stop_radius", options.stop_radius, above(0), "mm");
  if (sources.empty()) {
    throw InvalidInput("geodesic_distance: there is no source; pass at least one");
  }
  for (size_t i = 0; i < sources.size(); ++i) {
    const std::string what = "geodesic_distance: source " + std::to_string(i);
    check_surface_point(surface.mesh(), sources[i], what.c_str());
  }
  if (options.method == GeodesicMethod::exact) {
    return exact_geodesic_distance(surface, sources, options);
  }
  return fast_marching_distance(surface, sources, options.stop_radius);
}

}  // namespace palpate::geometry
