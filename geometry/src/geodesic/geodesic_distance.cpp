// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_distance.h"

#include <optional>
#include <string>

#include "geodesic/geodesic_methods.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/core/work_in_order.h"

namespace palpate::geometry {

namespace {

void check_sources(const GeodesicSurface& surface, std::span<const SurfacePoint> sources,
                   const GeodesicOptions& options) {
  require("GeodesicOptions::stop_radius", options.stop_radius, above(0), "mm");
  if (sources.empty()) {
    throw InvalidInput("geodesic_distance: there is no source; pass at least one");
  }
  for (size_t i = 0; i < sources.size(); ++i) {
    const std::string what = "geodesic_distance: source " + std::to_string(i);
    check_surface_point(surface.mesh(), sources[i], what.c_str());
  }
}

}  // namespace

GeodesicDistance geodesic_distance(const GeodesicSurface& surface,
                                   std::span<const SurfacePoint> sources,
                                   const GeodesicOptions& options) {
  check_sources(surface, sources, options);
  if (options.method == GeodesicMethod::exact) {
    return exact_geodesic_distance(surface, sources, options);
  }
  return fast_marching_distance(surface, sources, options.stop_radius);
}

Eigen::MatrixXd geodesic_distances(const GeodesicSurface& surface,
                                   std::span<const SurfacePoint> sources,
                                   const GeodesicOptions& options) {
  check_sources(surface, sources, options);
  GeodesicOptions quiet = options;
  quiet.progress = {};
  struct Wave {
    size_t source;
    Eigen::VectorXd distance;
  };
  Eigen::MatrixXd result(surface.mesh().vertices.cols(), static_cast<Eigen::Index>(sources.size()));
  size_t begun = 0;
  work_in_order<Wave>(
      [&]() -> std::optional<Wave> {
        if (begun == sources.size()) return std::nullopt;
        return Wave{.source = begun++, .distance = {}};
      },
      [&](Wave& wave) {
        wave.distance = geodesic_distance(surface, sources.subspan(wave.source, 1), quiet).distance;
      },
      [&](const Wave& wave) {
        result.col(static_cast<Eigen::Index>(wave.source)) = wave.distance;
        if (!options.progress) return;
        options.progress(static_cast<int>(wave.source) + 1, static_cast<int>(sources.size()));
      },
      usual_live_items());
  return result;
}

}  // namespace palpate::geometry
