// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/geodesic_methods.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "geodesic/bucket_queue.h"
#include "geodesic/geodesic_surface_data.h"

namespace palpate::geometry {
namespace {

/// A shorter path is propagated iff its squared length is shorter by more than this fraction: far
/// above rounding, so that the march terminates, and far below its accuracy.
constexpr double kWorthPassingOn = 2e-12;

/// Sources whose distances differ by at most this fraction are equally near, and the one with the
/// lowest index gets the vertex. Larger than what rounding and kWorthPassingOn add up to on a path.
constexpr double kEquallyNear = 1e-9;

/// Distance by which a wave is propagated beyond its cell, in units of the longest edge at a
/// vertex. Distances inside the cell depend on those of neighbours outside; a larger value does not
/// change the labels.
constexpr double kBeyondCell = 1;

/// The same beyond the radius, where no other wave can correct a label.
constexpr double kBeyondRadius = 3;

/// Width of a bucket of events in units of the mean longest edge: small enough that few vertices
/// are propagated too early.
constexpr double kBucketWidth = 0.1;

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Distance at corner `c` of a wave that passed the corners `a` and `b` at the given distances. The
/// triangle is laid in a plane with a = (0, 0), b = (e, 0) and c above. The wave comes from the
/// point S below with these distances from `a` and `b`. With the foot of S at u e, its depth y, and
/// c = (c_x, c_y):
///   2 u = (d_a^2 - d_b^2) / e^2 + 1
///   4 e^2 y^2 = ((d_a + d_b)^2 - e^2) (e^2 - (d_a - d_b)^2)
///   d_c^2 = d_a^2 + |ac|^2 - 2 u e c_x + 2 y c_y
/// Infinite if d_c is not shorter than `known`, which is tested without a square root, or if the
/// straight line from S to `c` misses the edge; the shortest path then runs along an edge or
/// through another triangle.
/// \param b, c    seen from a
/// \param corner  at a
double distance_across(double distance_a, double distance_b, const TriangleFans::Neighbour& b,
                       const TriangleFans::Neighbour& c, const TriangleFans::Corner& corner,
                       double known) {
  const auto [edge, inverse, side] = std::array{b.squared, b.inverse, c.squared};
  const auto [dot, cross] = std::array{corner.dot, corner.cross};
  const double sum = distance_a + distance_b;
  const double difference = distance_a - distance_b;
  const double steepness = edge - difference * difference;
  if (!(steepness >= 0 && edge > 0)) return kInfinity;
  const double twice_foot = difference * sum * inverse + 1;
  const double without_depth = distance_a * distance_a + side - twice_foot * dot;
  const double gain = known * known * (1 - kWorthPassingOn) - without_depth;
  // Negative by rounding if the source is on the edge.
  const double reach = std::max(0.0, sum * sum - edge);
  const double squared = reach * steepness * inverse * inverse * cross;  // (2 y c_y)^2
  if (!(gain > 0 && gain * gain > squared)) return kInfinity;
  const double depth = std::sqrt(squared);
  // Test that the line crosses the edge between `a` and `b`, multiplied by positive factors.
  if (!(twice_foot * cross + dot * depth >= 0)) return kInfinity;
  if (!((twice_foot - 2) * cross + (dot - edge) * depth <= 0)) return kInfinity;
  return std::sqrt(without_depth + depth);
}

/// A wave at a vertex.
struct Front {
  double distance = kInfinity;
  double start = 0;  ///< distance at the centre of its circle: 0, or that of a border corner
};

/// Start distance of the circle through two points, one of which may have been reached around a
/// corner that does not hide the other. Equal weights flatten the front behind the corner, and
/// weights in proportion to the curvatures bend it too much; the mean of both removes most of both
/// errors.
double common_start(const Front& a, const Front& b) {
  if (a.start == b.start) return a.start;
  const double radius_a = a.distance - a.start;
  const double radius_b = b.distance - b.start;
  const double even = 0.5 * (a.start + b.start);
  const double weighted = (a.start * radius_b + b.start * radius_a) / (radius_a + radius_b);
  return 0.5 * (even + weighted);
}

/// The shortest path found so far from the source of the wave to a vertex.
struct Arrival {
  Front front = {};
  int source = kNone;  ///< the arrival is of the wave of this source only
  bool waits = false;  ///< still to be propagated
};

struct Event {
  double distance;
  int vertex;
};

/// Lengths of shortest paths along the edges to the nearest of the sources, up to the radius: at
/// least the distances, and not much longer.
std::vector<double> distances_along_edges(const TriangleMesh& mesh, const TriangleFans& fans,
                                          std::span<const SurfacePoint> sources, double stop_radius,
                                          BucketQueue<Event>& events) {
  std::vector<double> distances(fans.longest.size(), kInfinity);
  const auto arrive = [&](int vertex, double distance) {
    if (!(distance < distances[static_cast<size_t>(vertex)])) return;
    distances[static_cast<size_t>(vertex)] = distance;
    events.push({.distance = distance, .vertex = vertex});
  };
  for (const SurfacePoint& source : sources) {
    const Eigen::Vector3d from = position(mesh, source);
    for (const int corner : mesh.triangles.col(source.triangle)) {
      arrive(corner, (mesh.vertices.col(corner) - from).norm());
    }
  }
  while (const std::optional<Event> event = events.pop()) {
    const auto v = static_cast<size_t>(event->vertex);
    if (event->distance > distances[v] || event->distance > stop_radius) continue;
    for (int i = fans.first_neighbour[v]; i < fans.first_neighbour[v + 1]; ++i) {
      const TriangleFans::Neighbour& neighbour = fans.neighbours[static_cast<size_t>(i)];
      arrive(neighbour.vertex, event->distance + neighbour.length);
    }
  }
  return distances;
}

/// The waves of all sources on the mesh, one after the other.
///
/// Each source has its own wave, because a triangle that mixes two of them is valid for neither; it
/// ends a little inside the neighbouring cells. Where their waves have not run yet, they are
/// estimated by paths along the edges. Around a corner of the border a wave continues in circles
/// about the corner. Unlike in a march in strict order, a vertex that is reached later on a shorter
/// path is propagated again: in an obtuse triangle the wave may reach one corner before the other
/// two. A longer distance at two corners never makes the third one shorter, so the order of events
/// does not affect the result, except for the circles at the edge of a corner's shadow.
class March {
 public:
  /// Mesh and fans must outlive the march.
  March(const TriangleMesh& mesh, const TriangleFans& fans, std::span<const SurfacePoint> sources,
        double stop_radius)
      : mesh_(mesh),
        stop_radius_(stop_radius),
        fans_(fans),
        events_(kBucketWidth * mean(fans_.longest)),
        arrivals_(fans_.longest.size()),
        nearest_{.distance = Eigen::VectorXd::Constant(mesh.vertices.cols(), kInfinity),
                 .label = Eigen::VectorXi::Constant(mesh.vertices.cols(), kNone)} {
    farthest_.assign(fans_.longest.size(), kInfinity);
    if (sources.size() <= 1) return;
    const std::vector<double> along_edges =
        distances_along_edges(mesh, fans_, sources, stop_radius, events_);
    for (size_t v = 0; v < farthest_.size(); ++v) farthest_[v] = beyond_cell(v, along_edges[v]);
  }

  /// Runs the wave of a source.
  void run(const SurfacePoint& at, int source) {
    events_.restart();
    touched_.clear();
    source_ = source;
    const Eigen::Vector3d from = position(mesh_, at);
    for (const int corner : mesh_.triangles.col(at.triangle)) {
      arrive(corner, {.distance = (mesh_.vertices.col(corner) - from).norm(), .start = 0});
    }
    while (const std::optional<Event> event = events_.pop()) {
      Arrival& arrival = arrivals_[static_cast<size_t>(event->vertex)];
      // Skip the event if a shorter path was found meanwhile.
      if (!arrival.waits || event->distance > arrival.front.distance) continue;
      arrival.waits = false;
      const double edge = fans_.longest[static_cast<size_t>(event->vertex)];
      if (arrival.front.distance > stop_radius_ + kBeyondRadius * edge) continue;
      pass_on(event->vertex);
    }
    for (const int vertex : touched_) keep_nearest(vertex);
  }

  /// The result of the waves so far.
  [[nodiscard]] const GeodesicDistance& nearest() const { return nearest_; }
  [[nodiscard]] GeodesicDistance result() && { return std::move(nearest_); }

 private:
  /// The distance up to which waves matter at a vertex, if its source is no farther than this.
  [[nodiscard]] double beyond_cell(size_t v, double distance) const {
    return distance * (1 + kEquallyNear) + kBeyondCell * fans_.longest[v];
  }

  void keep_nearest(int vertex) {
    const auto v = static_cast<size_t>(vertex);
    const double distance = arrivals_[v].front.distance;
    double& nearest = nearest_.distance[vertex];
    if (!(distance <= stop_radius_)) return;
    int& label = nearest_.label[vertex];
    const bool is_nearer = distance * (1 + kEquallyNear) < nearest;
    const bool is_tie = !is_nearer && distance <= nearest * (1 + kEquallyNear);
    if (is_nearer || (is_tie && source_ < label)) label = source_;
    nearest = std::min(nearest, distance);
    farthest_[v] = std::min(farthest_[v], beyond_cell(v, distance));
  }

  void arrive(int vertex, const Front& front) {
    const auto v = static_cast<size_t>(vertex);
    Arrival& arrival = arrivals_[v];
    if (arrival.source != source_) {
      if (front.distance > farthest_[v]) return;
      arrival = {.front = {}, .source = source_, .waits = false};
      touched_.push_back(vertex);
    }
    if (!(front.distance < arrival.front.distance * (1 - kWorthPassingOn))) return;
    arrival.front = front;
    arrival.waits = true;
    events_.push({.distance = front.distance, .vertex = vertex});
  }

  void pass_on(int vertex) {
    const auto v = static_cast<size_t>(vertex);
    const Front own = arrivals_[v].front;
    const TriangleFans::Neighbour* neighbours =
        &fans_.neighbours[static_cast<size_t>(fans_.first_neighbour[v])];
    const int count = fans_.first_neighbour[v + 1] - fans_.first_neighbour[v];
    reached_.clear();
    for (int i = 0; i < count; ++i) {
      const Arrival& arrival = arrivals_[static_cast<size_t>(neighbours[i].vertex)];
      const bool has_arrived = arrival.source == source_;
      const Front known = has_arrived ? arrival.front : Front{};
      reached_.push_back({.settled = has_arrived && !arrival.waits,
                          .known = known,
                          .shortest = {.distance = own.distance + neighbours[i].length,
                                       .start = fans_.turns[v] ? own.distance : own.start}});
    }
    const auto across = [&](const TriangleFans::Corner& corner, int over, int to) {
      const Reached& base = reached_[static_cast<size_t>(over)];
      Reached& target = reached_[static_cast<size_t>(to)];
      if (!base.settled) return;
      const double start = common_start(own, base.known);
      const double known = std::min(target.known.distance, target.shortest.distance);
      const double radius =
          distance_across(own.distance - start, base.known.distance - start, neighbours[over],
                          neighbours[to], corner, known - start);
      if (start + radius < known) target.shortest = {.distance = start + radius, .start = start};
    };
    for (int i = fans_.first_corner[v]; i < fans_.first_corner[v + 1]; ++i) {
      const TriangleFans::Corner& corner = fans_.corners[static_cast<size_t>(i)];
      across(corner, corner.last, corner.next);
      across(corner, corner.next, corner.last);
    }
    for (int i = 0; i < count; ++i) {
      const Reached& target = reached_[static_cast<size_t>(i)];
      if (target.shortest.distance < target.known.distance) {
        arrive(neighbours[i].vertex, target.shortest);
      }
    }
  }

  /// Knowledge about a neighbour of the vertex that is being propagated.
  struct Reached {
    bool settled;    ///< its distance has been propagated, so others may depend on it
    Front known;     ///< infinite if not reached
    Front shortest;  ///< of the paths found now; infinite if none is shorter
  };

  const TriangleMesh& mesh_;
  double stop_radius_;
  const TriangleFans& fans_;
  BucketQueue<Event> events_;
  std::vector<Arrival> arrivals_;  ///< of each vertex
  std::vector<double> farthest_;   ///< of each vertex: waves farther than this end before it
  std::vector<int> touched_;       ///< vertices that the wave has reached
  int source_ = kNone;             ///< of the wave
  GeodesicDistance nearest_;       ///< result of the waves so far
  std::vector<Reached> reached_;   ///< scratch
};

/// The sources by triangle: waves that run one after the other then use the same part of the
/// memory.
std::vector<int> neighbours_in_succession(std::span<const SurfacePoint> sources) {
  std::vector<int> order(sources.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return sources[static_cast<size_t>(a)].triangle < sources[static_cast<size_t>(b)].triangle;
  });
  return order;
}

}  // namespace

GeodesicDistance fast_marching_distance(const GeodesicSurface& surface,
                                        std::span<const SurfacePoint> sources, double stop_radius) {
  March march(surface.mesh(), surface.impl().fans(), sources, stop_radius);
  for (const int i : neighbours_in_succession(sources)) {
    march.run(sources[static_cast<size_t>(i)], i);
  }
  return std::move(march).result();
}

void grow_distances(
    const TriangleMesh& mesh,
    const std::function<std::optional<SurfacePoint>(const Eigen::VectorXd& distances)>& next) {
  const TriangleFans fans = triangle_fans(mesh);
  March march(mesh, fans, {}, kInfinity);
  for (int source = 0;; ++source) {
    const std::optional<SurfacePoint> at = next(march.nearest().distance);
    if (!at) return;
    march.run(*at, source);
  }
}

}  // namespace palpate::geometry
