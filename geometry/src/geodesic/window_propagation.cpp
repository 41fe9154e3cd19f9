// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/window_propagation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace palpate::geometry {
namespace {

/// A window is dropped iff a path through a vertex is shorter by more than this fraction: above
/// the margin of EdgeWindows, so that no two windows drop each other.
constexpr double kShorterThroughVertex = 1e-12;

/// A window that ends within this fraction of an edge from the line to a vertex reaches the vertex.
constexpr double kReaches = 1e-14;

/// Windows are passed on together if their distances differ by less than this, in units of the mean
/// edge: small enough that few are passed on before a nearer one arrives.
constexpr double kTogether = 0.3;

/// Length along the ray from (0, 0) in the given direction at which the line from (along, -height)
/// through (place, 0) hits it. Precondition: it does, and place >= 0.
double hit(double place, double along, double height, const Eigen::Vector2d& direction,
           double longest) {
  if (place == 0) return 0;
  const double at = place * height / (direction.x() * height + direction.y() * (along - place));
  return std::clamp(at, 0.0, longest);
}

}  // namespace

WindowPropagation::WindowPropagation(const FlatTriangles& flat, double stop_radius)
    : flat_(flat),
      stop_radius_(stop_radius),
      together_(kTogether * flat.mean_length),
      distance_(flat.bends.size(), kInfinity),
      source_(flat.bends.size(), kNone),
      bends_(flat.bends),
      windows_(static_cast<size_t>(flat.edge_count)),
      expected_(flat.half_edges.size(), kInfinity),
      arrivals_(together_) {}

void WindowPropagation::start(const SurfacePoint& at, int source) {
  const Eigen::Vector3d positive = at.barycentric.cwiseMax(0);
  const Eigen::Vector3d weights = positive / positive.sum();
  Eigen::Index largest = 0, smallest = 0;
  weights.maxCoeff(&largest);
  weights.minCoeff(&smallest);
  const auto corners = (weights.array() > 0).count();
  if (corners == 1) {
    const int vertex = flat_[3 * at.triangle + static_cast<int>(largest)].start;
    if (improve(vertex, 0, source)) spread(vertex);
    return;
  }
  start_in(at.triangle, weights, source);
  const int across = flat_[3 * at.triangle + (static_cast<int>(smallest) + 1) % 3].opposite;
  if (corners == 3 || across == kNone) return;
  // A source on an edge also starts in the triangle on the other side, where the edge is
  // reversed.
  Eigen::Vector3d other = Eigen::Vector3d::Zero();
  other[across % 3] = weights[(smallest + 2) % 3];
  other[(across + 1) % 3] = weights[(smallest + 1) % 3];
  start_in(across / 3, other, source);
}

bool WindowPropagation::step() {
  const std::optional<Arrival> arrival = arrivals_.pop();
  if (!arrival) return false;
  if (arrival->distance > stop_radius_) return true;
  if (arrival->at == ArrivalAt::vertex) {
    if (arrival->distance == distance(arrival->index)) spread(arrival->index);
  } else if (arrival->at == ArrivalAt::whole_edge) {
    windows_.finish(arrival->index, keeps_windows_);
  } else if (double& expected = expected_[static_cast<size_t>(arrival->index)];
             arrival->distance == expected) {
    expected = kInfinity;
    pass_on(arrival->index, arrival->distance + together_);
  }
  return true;
}

void WindowPropagation::run(const std::function<void(int done, int total)>& progress) {
  keeps_windows_ = false;
  constexpr std::size_t kSteps = 4096;  // between two calls
  const int total = static_cast<int>(distance_.size());
  for (std::size_t i = 1; step(); ++i) {
    if (progress && i % kSteps == 0) progress(std::min(reached_, total - 1), total);
  }
  if (progress) progress(total, total);
}

void WindowPropagation::run_to(std::span<const SurfacePoint> targets) {
  // Checking costs a look at each target.
  const std::size_t kSteps = 1000 + targets.size();
  for (std::size_t i = 1; step(); ++i) {
    if (i % kSteps != 0) continue;
    double farthest = 0;
    for (const SurfacePoint& target : targets) {
      const Eigen::Vector3d weights = target.barycentric;
      double bound = kInfinity;
      for (int k = 0; k < 3; ++k) {
        // Within the triangle a corner is no farther than by this mean of its two edges.
        const int h = 3 * target.triangle + k;
        const double to_corner = std::abs(weights[(k + 1) % 3]) * flat_[h].length +
                                 std::abs(weights[(k + 2) % 3]) * flat_[last_half_edge(h)].length;
        bound = std::min(bound, distance(flat_[h].start) + to_corner);
      }
      farthest = std::max(farthest, bound);
    }
    stop_radius_ = std::min(stop_radius_, farthest);
  }
}

bool WindowPropagation::improve(int vertex, double distance, int source) {
  double& known = distance_[static_cast<size_t>(vertex)];
  if (!(distance < known)) return false;
  const bool is_first = known == kInfinity;
  known = distance;
  source_[static_cast<size_t>(vertex)] = source;
  if (is_first) {
    ++reached_;
    expect_edges_at(vertex);
  }
  return true;
}

void WindowPropagation::reach(int vertex, double distance, int source) {
  if (!improve(vertex, distance, source) || bends_[static_cast<size_t>(vertex)] == 0) return;
  arrivals_.push({.distance = distance, .index = vertex, .at = ArrivalAt::vertex});
}

void WindowPropagation::expect(int half_edge, double distance) {
  double& expected = expected_[static_cast<size_t>(half_edge)];
  if (!(distance < expected)) return;
  expected = distance;
  arrivals_.push({.distance = distance, .index = half_edge, .at = ArrivalAt::half_edge});
}

/// Each edge whose other end is reached: all of it is as near as by the better of its ends. Windows
/// passed on in later buckets are farther. Edges of the border have no windows.
void WindowPropagation::expect_edges_at(int vertex) {
  for (const int h : flat_.from(vertex)) {
    const double there = distance(flat_[next_half_edge(h)].start);
    if (there == kInfinity) continue;
    const double farthest = (distance(vertex) + there + flat_[h].length) / 2;
    if (!arrivals_.is_in_order(farthest + together_)) continue;
    arrivals_.push(
        {.distance = farthest + together_, .index = flat_[h].edge, .at = ArrivalAt::whole_edge});
  }
}

/// Starts from a point in a triangle that is not one of its vertices.
void WindowPropagation::start_in(int triangle, const Eigen::Vector3d& weights, int source) {
  std::array<Eigen::Vector2d, 3> points;  // in the plane of each half-edge
  for (int k = 0; k < 3; ++k) {
    const int h = 3 * triangle + k;
    Eigen::Vector2d& point = points[static_cast<size_t>(k)];
    point = weights[(k + 2) % 3] * flat_.apex(h);
    point.x() += weights[(k + 1) % 3] * flat_[h].length;
    if (point.norm() < kClose * flat_[h].length) bends_[static_cast<size_t>(flat_[h].start)] = 1;
    reach(flat_[h].start, point.norm(), source);
  }
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d& point = points[static_cast<size_t>(k)];
    if (point.y() > 0) leave(3 * triangle + k, point, 0, source);
  }
}

/// Continues from a vertex into all its triangles.
void WindowPropagation::spread(int vertex) {
  const double start = distance(vertex);
  const int source = this->source(vertex);
  for (const int h : flat_.from(vertex)) {
    const int far = next_half_edge(h);
    const int last = last_half_edge(h);
    reach(flat_[far].start, start + flat_[h].length, source);
    reach(flat_[last].start, start + flat_[last].length, source);
    leave(far, flat_.apex(far), start, source);
  }
}

/// Leaves the triangle from a point in it through all of a half-edge.
void WindowPropagation::leave(int half_edge, const Eigen::Vector2d& point, double start,
                              int source) {
  add(half_edge, {.begin = 0,
                  .end = flat_[half_edge].length,
                  .along = point.x(),
                  .height = point.y(),
                  .start = start,
                  .source = source,
                  .forward = false});
}

/// Adds a window on a half-edge, in the direction of the half-edge, that leaves the triangle.
void WindowPropagation::add(int h, const Window& window) {
  const FlatHalfEdge& half_edge = flat_[h];
  if (!(window.begin < window.end) || windows_.is_finished(half_edge.edge)) return;
  const int first = half_edge.start;
  const int second = flat_[next_half_edge(h)].start;
  const double before = window.begin;
  const double after = half_edge.length - window.end;
  const double at_begin = window.at(window.begin);
  const double at_end = window.at(window.end);
  // Reach the vertices as well, so that none is missed in a gap that rounding leaves.
  reach(first, at_begin + before, window.source);
  reach(second, at_end + after, window.source);
  if (half_edge.opposite == kNone) return;
  // Paths through the vertices may be shorter everywhere in the window (Xin and Wang 2009).
  constexpr double kMargin = 1 - kShorterThroughVertex;
  if (distance(first) + window.end < kMargin * at_end) return;
  if (distance(second) + half_edge.length - window.begin < kMargin * at_begin) return;
  Window added = half_edge.along_edge ? window : turned(window, half_edge.length);
  added.forward = !half_edge.along_edge;
  added.waits = true;
  expect(half_edge.opposite, windows_.add(half_edge.edge, added));
}

/// Passes on the windows that enter a triangle through a half-edge, up to a distance.
void WindowPropagation::pass_on(int h, double farthest) {
  const FlatHalfEdge& half_edge = flat_[h];
  double rest = kInfinity;
  for (Window& window : windows_.of(half_edge.edge)) {
    if (!window.waits || window.forward != half_edge.along_edge) continue;
    const double least = window.least();
    if (least > farthest) {
      rest = std::min(rest, least);
      continue;
    }
    window.waits = false;
    cross(h, half_edge.along_edge ? window : turned(window, half_edge.length));
  }
  expect(h, rest);
}

/// Passes a window, in the direction of the half-edge, through the triangle.
void WindowPropagation::cross(int h, const Window& window) {
  const FlatHalfEdge& half_edge = flat_[h];
  const int right = next_half_edge(h);
  const int left = last_half_edge(h);
  const Eigen::Vector2d apex = flat_.apex(h);
  // The place at which the line to the apex crosses the edge.
  const double to_apex =
      (window.along * apex.y() + apex.x() * window.height) / (window.height + apex.y());
  const double slack = kReaches * half_edge.length;
  const bool reaches_from_left = window.end >= to_apex - slack;
  const bool reaches_from_right = window.begin <= to_apex + slack;
  if (reaches_from_left && reaches_from_right) {
    const double aside = window.along - apex.x();
    const double depth = window.height + apex.y();
    reach(flat_[left].start, window.start + std::sqrt(aside * aside + depth * depth),
          window.source);
  }
  if (window.begin < to_apex) {
    const Window hitting =
        hitting_window(window, half_edge.left, flat_[left].length, reaches_from_left);
    if (!is_longer_than_through(flat_[right].start, half_edge, half_edge.left, hitting)) {
      add(left, turned(hitting, flat_[left].length));
    }
  }
  if (window.end > to_apex) {
    const Window hitting = hitting_window(turned(window, half_edge.length), half_edge.right,
                                          flat_[right].length, reaches_from_right);
    if (!is_longer_than_through(half_edge.start, half_edge, half_edge.right, hitting)) {
      add(right, hitting);
    }
  }
}

/// The window on another edge of the triangle, which runs from (0, 0) in the given direction.
Window WindowPropagation::hitting_window(const Window& window, const Eigen::Vector2d& direction,
                                         double length, bool reaches_end) {
  const auto [begin, end, along, height] =
      std::array{window.begin, window.end, window.along, window.height};
  Window hitting = window;
  hitting.begin = hit(begin, along, height, direction, length);
  hitting.end = reaches_end ? length : hit(end, along, height, direction, length);
  hitting.along = along * direction.x() - height * direction.y();
  // Negative by rounding only.
  hitting.height = std::max(0.0, height * direction.x() + along * direction.y());
  return hitting;
}

/// Returns true if paths through the other end of the edge that a window has crossed are shorter
/// everywhere in the window (Xin and Wang 2009).
bool WindowPropagation::is_longer_than_through(int vertex, const FlatHalfEdge& crossed,
                                               const Eigen::Vector2d& direction,
                                               const Window& hitting) const {
  constexpr double kMargin = 1 - kShorterThroughVertex;
  const double gain = kMargin * hitting.at(hitting.begin) - distance(vertex);
  if (!(gain > 0)) return false;
  const double aside = hitting.begin * direction.x() - crossed.length;
  const double depth = hitting.begin * direction.y();
  return gain * gain > aside * aside + depth * depth;
}

}  // namespace palpate::geometry
