// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_path.h"

#include <algorithm>
#include <string>

#include "geodesic/geodesic_surface_data.h"
#include "geodesic/straight_strip.h"
#include "geodesic/window_propagation.h"
#include "geodesic/window_trace.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// A path is as long as the exact distance within this fraction of it and of the mean edge.
constexpr double kAccuracy = 1e-9;

void check_points(const TriangleMesh& mesh, std::span<const SurfacePoint> points,
                  const std::string& what) {
  for (size_t i = 0; i < points.size(); ++i)
    check_surface_point(mesh, points[i], (what + " " + std::to_string(i)).c_str());
}

/// \throws InvalidInput as `strips_along`.
GeodesicPath straightened(const FlatTriangles& flat, std::span<const SurfacePoint> points) {
  GeodesicPath path;
  for (const TriangleStrip& strip : strips_along(flat, points)) {
    const StraightPath part = straighten(flat, strip);
    // The end of one strip is the beginning of the next one.
    const auto begin = part.points.begin() + (path.points.empty() ? 0 : 1);
    path.points.insert(path.points.end(), begin, part.points.end());
    path.length += part.length;
  }
  return path;
}

}  // namespace

std::vector<std::optional<GeodesicPath>> shortest_paths(const GeodesicSurface& surface,
                                                        std::span<const SurfacePoint> sources,
                                                        std::span<const SurfacePoint> targets) {
  if (sources.empty()) throw InvalidInput("shortest_paths: there is no source; pass at least one");
  check_points(surface.mesh(), sources, "shortest_paths: source");
  check_points(surface.mesh(), targets, "shortest_paths: target");
  const FlatTriangles& flat = surface.impl().flat();
  WindowPropagation propagation(flat, kInfinity);
  for (size_t i = 0; i < sources.size(); ++i) propagation.start(sources[i], static_cast<int>(i));
  propagation.run_to(targets);
  const WindowTrace trace(flat, propagation, sources);
  std::vector<std::optional<GeodesicPath>> paths;
  for (size_t i = 0; i < targets.size(); ++i) {
    TracedPath back = trace.to(targets[i]);
    if (back.source == kNone) {
      paths.emplace_back();
      continue;
    }
    std::reverse(back.points.begin(), back.points.end());
    GeodesicPath path = straightened(flat, back.points);
    if (!(path.length <= back.distance + kAccuracy * (back.distance + flat.mean_length))) {
      throw SolverError("shortest_paths: the way to target " + std::to_string(i) +
                        " is lost in rounding; the mesh has triangles that are too thin, remove "
                        "them");
    }
    path.length /= flat.unit;
    path.source = back.source;
    paths.emplace_back(std::move(path));
  }
  return paths;
}

GeodesicPath straighten_path(const GeodesicSurface& surface, std::span<const SurfacePoint> path) {
  if (path.size() < 2) {
    throw InvalidInput("straighten_path: the path has " + std::to_string(path.size()) +
                       " points; pass at least its two ends");
  }
  check_points(surface.mesh(), path, "straighten_path: point");
  const FlatTriangles& flat = surface.impl().flat();
  GeodesicPath straight = straightened(flat, path);
  straight.length /= flat.unit;
  return straight;
}

}  // namespace palpate::geometry
