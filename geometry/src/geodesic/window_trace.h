// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "geodesic/window_propagation.h"

namespace palpate::geometry {

/// A way back from a target to a source.
struct TracedPath {
  int source = kNone;                ///< kNone if no source is reached
  double distance = kInfinity;       ///< in the unit of the flat triangles
  std::vector<SurfacePoint> points;  ///< from the target to the source; neighbours in one triangle
};

/// Follows the windows of a propagation back to the sources that it was started from.
class WindowTrace {
 public:
  /// All must outlive the trace.
  WindowTrace(const FlatTriangles& flat, const WindowPropagation& propagation,
              std::span<const SurfacePoint> sources);

  /// \throws SolverError if rounding leads the way astray.
  [[nodiscard]] TracedPath to(const SurfacePoint& target) const;

 private:
  /// A source with the name of its place in a triangle; those at vertices are not needed.
  struct NamedSource {
    int triangle;
    Eigen::Vector3d weights;
    int source;
  };
  /// The first part of the way back: to a source, to a vertex, or through a window.
  struct Step {
    double distance = kInfinity;
    SurfacePoint to;     ///< the source, the vertex, or where the way crosses an edge
    int source = kNone;  ///< unless it goes on
    int vertex = kNone;
    int half_edge = kNone;  ///< that is crossed
    Window window{};        ///< in the direction of the half-edge
    double place = 0;       ///< position at which the half-edge is crossed
  };

  [[nodiscard]] std::span<const NamedSource> sources_in(int triangle) const;
  void try_sources(const SurfacePoint& at, Step& best) const;
  void try_windows(const SurfacePoint& at, Step& best) const;
  void try_corners(const SurfacePoint& at, Step& best) const;
  [[nodiscard]] Step first_step(const SurfacePoint& at) const;
  [[nodiscard]] Step follow(const Step& through, std::vector<SurfacePoint>& points) const;
  [[nodiscard]] Step to_vertex(int half_edge) const;
  [[nodiscard]] Eigen::Vector2d in_plane_of(int half_edge, const Eigen::Vector3d& weights) const;

  const FlatTriangles& flat_;
  const WindowPropagation& propagation_;
  std::vector<NamedSource> sources_;  ///< sorted by triangle
};

}  // namespace palpate::geometry
