// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/window_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geodesic/triangle_strip.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// A step through a window is taken unless another one is shorter by more than this fraction of the
/// distance, which is rounding.
constexpr double kShorterStep = 1e-13;

/// A way through a window has come to the point of the window within this fraction of its length,
/// above the rounding of many triangles.
constexpr double kArrived = 1e-10;

SurfacePoint on_half_edge(int half_edge, double share) {
  SurfacePoint point{.triangle = half_edge / 3};
  point.barycentric[half_edge % 3] = 1 - share;
  point.barycentric[(half_edge + 1) % 3] = share;
  return point;
}

/// The end of a path that is followed along the lines of a window, in the plane of the half-edge
/// through which it has entered a triangle.
struct TracedLine {
  int half_edge;
  Eigen::Vector2d at;  ///< on the half-edge
  Eigen::Vector2d to;  ///< the point of the window
};

}  // namespace

WindowTrace::WindowTrace(const FlatTriangles& flat, const WindowPropagation& propagation,
                         std::span<const SurfacePoint> sources)
    : flat_(flat), propagation_(propagation) {
  for (size_t i = 0; i < sources.size(); ++i) {
    for (const SurfacePoint& name : names_of(flat, sources[i])) {
      if ((name.barycentric.array() > 0).count() == 1) break;
      sources_.push_back({name.triangle, name.barycentric, static_cast<int>(i)});
    }
  }
  std::stable_sort(sources_.begin(), sources_.end(),
                   [](const auto& a, const auto& b) { return a.triangle < b.triangle; });
}

std::span<const WindowTrace::NamedSource> WindowTrace::sources_in(int triangle) const {
  const auto [first, last] =
      std::equal_range(sources_.begin(), sources_.end(), NamedSource{triangle, {}, 0},
                       [](const auto& a, const auto& b) { return a.triangle < b.triangle; });
  return {first, last};
}

Eigen::Vector2d WindowTrace::in_plane_of(int half_edge, const Eigen::Vector3d& weights) const {
  Eigen::Vector2d point = weights[(half_edge + 2) % 3] * flat_.apex(half_edge);
  point.x() += weights[(half_edge + 1) % 3] * flat_[half_edge].length;
  return point;
}

void WindowTrace::try_sources(const SurfacePoint& at, Step& best) const {
  const int base = 3 * at.triangle;
  for (const NamedSource& source : sources_in(at.triangle)) {
    const double distance =
        (in_plane_of(base, source.weights) - in_plane_of(base, at.barycentric)).norm();
    if (!(distance < best.distance)) continue;
    best = {.distance = distance, .to = {at.triangle, source.weights}, .source = source.source};
  }
}

void WindowTrace::try_windows(const SurfacePoint& at, Step& best) const {
  for (int h = 3 * at.triangle; h < 3 * at.triangle + 3; ++h) {
    const FlatHalfEdge& half_edge = flat_[h];
    if (half_edge.opposite == kNone || !(at.barycentric[(h + 2) % 3] > 0)) continue;
    const Eigen::Vector2d from = in_plane_of(h, at.barycentric);
    for (const Window& known : propagation_.windows(half_edge.edge)) {
      if (known.forward != half_edge.along_edge) continue;
      const Window window = half_edge.along_edge ? known : turned(known, half_edge.length);
      const double crossed =
          window.along + (from.x() - window.along) * window.height / (window.height + from.y());
      const double place = std::clamp(crossed, window.begin, window.end);
      const double distance = window.at(place) + (from - Eigen::Vector2d(place, 0)).norm();
      if (!(distance < (1 - kShorterStep) * best.distance)) continue;
      best = {.distance = distance,
              .to = on_half_edge(h, std::clamp(place / half_edge.length, 0.0, 1.0)),
              .half_edge = h,
              .window = window,
              .place = place};
    }
  }
}

void WindowTrace::try_corners(const SurfacePoint& at, Step& best) const {
  for (int k = 0; k < 3; ++k) {
    if (at.barycentric[k] == 1) continue;
    const int h = 3 * at.triangle + k;
    const double known = propagation_.distance(flat_[h].start);
    const double distance = known + in_plane_of(h, at.barycentric).norm();
    if (!(distance < (1 - kShorterStep) * best.distance)) continue;
    best = to_vertex(h);
    best.distance = distance;
  }
}

/// The vertex at which a half-edge starts; the end of the way if a source is there.
WindowTrace::Step WindowTrace::to_vertex(int half_edge) const {
  const int vertex = flat_[half_edge].start;
  Step step{.to = corner_point(half_edge / 3, half_edge % 3), .vertex = vertex};
  if (propagation_.distance(vertex) == 0) step.source = propagation_.source(vertex);
  return step;
}

WindowTrace::Step WindowTrace::first_step(const SurfacePoint& at) const {
  Step best;
  const std::vector<SurfacePoint> names = names_of(flat_, at);
  for (const SurfacePoint& name : names) try_sources(name, best);
  for (const SurfacePoint& name : names) try_windows(name, best);
  for (const SurfacePoint& name : names) try_corners(name, best);
  return best;
}

/// Follows the line through a window to its point, which is a source or a vertex.
WindowTrace::Step WindowTrace::follow(const Step& through,
                                      std::vector<SurfacePoint>& points) const {
  const FlatHalfEdge& entry = flat_[through.half_edge];
  TracedLine line{.half_edge = entry.opposite,
                  .at = {entry.length - through.place, 0},
                  .to = {entry.length - through.window.along, through.window.height}};
  const double near = kArrived * (line.to - line.at).norm();
  for (size_t steps = 0; steps <= flat_.half_edges.size(); ++steps) {
    const int h = line.half_edge;
    const double length = flat_[h].length;
    const Eigen::Vector2d apex = flat_.apex(h);
    const std::array<Eigen::Vector2d, 3> corners = {Eigen::Vector2d(0, 0),
                                                    Eigen::Vector2d(length, 0), apex};
    const double enough = near + kArrived * length;
    for (const NamedSource& source : sources_in(h / 3)) {
      if (source.source != through.window.source || through.window.start > 0) continue;
      if ((in_plane_of(h, source.weights) - line.to).norm() <= enough)
        return {.to = {h / 3, source.weights}, .source = source.source};
    }
    const bool is_left = cross(apex - line.at, line.to - line.at) > 0;
    const int exit = is_left ? last_half_edge(h) : next_half_edge(h);
    const Eigen::Vector2d& begin = is_left ? apex : corners[1];
    const Eigen::Vector2d& end = is_left ? corners[0] : apex;
    // The corner that the point is at, or the one next to which it is if the line ends here.
    const bool ends = cross(end - begin, line.to - begin) >= 0 || flat_[exit].opposite == kNone;
    const auto nearest = std::min_element(corners.begin(), corners.end(),
                                          [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                                            return (a - line.to).norm() < (b - line.to).norm();
                                          });
    if (ends || (*nearest - line.to).norm() <= enough) {
      const std::array<int, 3> from = {h, next_half_edge(h), last_half_edge(h)};
      return to_vertex(from[static_cast<size_t>(nearest - corners.begin())]);
    }
    const Eigen::Vector2d way = line.to - line.at;
    const double at_begin = cross(way, begin - line.at);
    const double at_end = cross(way, end - line.at);
    const double share = std::clamp(at_begin / (at_begin - at_end), 0.0, 1.0);
    points.push_back(on_half_edge(exit, share));
    // Into the plane of the other side, where the edge runs from `end` to `begin`.
    const double exit_length = flat_[exit].length;
    const Eigen::Vector2d axis =
        is_left ? flat_[h].left : Eigen::Vector2d(flat_[h].right.x(), -flat_[h].right.y());
    const Eigen::Vector2d to = line.to - end;
    line = {.half_edge = flat_[exit].opposite,
            .at = {(1 - share) * exit_length, 0},
            .to = {axis.dot(to), std::max(0.0, cross(axis, to))}};
  }
  throw SolverError(
      "shortest_paths: rounding leads the way round in circles; the mesh has "
      "triangles that are too thin, remove them");
}

TracedPath WindowTrace::to(const SurfacePoint& target) const {
  TracedPath path;
  path.points = {{target.triangle, clean_weights(target)}};
  const std::vector<SurfacePoint> names = names_of(flat_, target);
  if (const auto& w = names.front().barycentric; (w.array() > 0).count() == 1) {
    Eigen::Index corner = 0;
    w.maxCoeff(&corner);
    const int vertex = flat_[3 * names.front().triangle + static_cast<int>(corner)].start;
    if (propagation_.distance(vertex) == 0) {
      path.source = propagation_.source(vertex);
      path.distance = 0;
      path.points.push_back(path.points.front());
      return path;
    }
  }
  Step step = first_step(path.points.back());
  if (step.distance == kInfinity) return path;
  path.distance = step.distance;
  // Each vertex on the way is nearer to the source than the one before.
  double last = kInfinity;
  while (true) {
    path.points.push_back(step.to);
    if (step.half_edge != kNone) {
      step = follow(step, path.points);
      path.points.push_back(step.to);
    }
    if (step.source != kNone) break;
    const double now = propagation_.distance(step.vertex);
    if (!(now < last)) {
      throw SolverError(
          "shortest_paths: the way back to the source is lost in rounding at vertex " +
          std::to_string(step.vertex) + "; the mesh has triangles that are too thin, remove them");
    }
    last = now;
    step = first_step(step.to);
  }
  path.source = step.source;
  return path;
}

}  // namespace palpate::geometry
