// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/geodesic_methods.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "base/numbers.h"
#include "mesh/triangle_fans.h"

namespace palpate::geometry {
namespace {

/// A shorter path is propagated iff its squared length is shorter by more than this fraction: far
/// above rounding, so that the march terminates, and far below its accuracy.
constexpr double kWorthPassingOn = 2e-12;

/// Sources whose distances differ by at most this fraction are equally near, and the one with the
/// lowest index gets the vertex. Larger than what rounding and kWorthPassingOn add up to on a path.
constexpr double kEquallyNear = 1e-9;

/// How far beyond its cell a wave is propagated, in units of the longest edge at a vertex.
/// Distances inside the cell depend on those of neighbours outside; a larger value does not change
/// the labels.
constexpr double kBeyondCell = 1;

/// The same beyond the radius, where no other wave can correct a label.
constexpr double kBeyondRadius = 3;

/// Width of a bucket of events in units of the mean longest edge: small enough that few vertices
/// are propagated too early.
constexpr double kBucketWidth = 0.1;

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Distance at the far end of an edge of the given squared length, if it is shorter than `known`.
double distance_along(double distance, double squared_length, double known) {
  const double gain = known - distance;
  if (!(gain > 0 && gain * gain > squared_length)) return kInfinity;
  return distance + std::sqrt(squared_length);
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
/// \param edge  e^2
/// \param side  |ac|^2
/// \param dot   e c_x
/// \param cross (e c_y)^2
double distance_across(double distance_a, double distance_b, double edge, double side, double dot,
                       double cross, double known) {
  const double sum = distance_a + distance_b;
  const double difference = distance_a - distance_b;
  const double steepness = edge - difference * difference;
  if (!(steepness >= 0 && edge > 0)) return kInfinity;
  const double inverse = 1 / edge;
  const double twice_foot = difference * sum * inverse + 1;
  const double without_depth = distance_a * distance_a + side - twice_foot * dot;
  const double gain = known * known * (1 - kWorthPassingOn) - without_depth;
  // Negative by rounding where the source is on the edge.
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

/// The shortest distance found so far from one source to one vertex.
struct Arrival {
  Front front = {};
  int source = kNone;
  int next = kNone;  ///< arrival of another source at the same vertex
  int vertex = kNone;
  bool waits = false;  ///< still to be propagated
};

struct Event {
  double distance;
  int arrival;
};

/// Queue of arrivals to be propagated, nearest bucket first and first in first out within a bucket.
/// This is sufficient because the march corrects what was propagated too early; it needs no sorting
/// and keeps neighbours together.
class Events {
 public:
  /// \param width  [mm] of a bucket
  explicit Events(double width) : per_width_(1 / width) {}

  void push(const Event& event) {
    // The order of arguments matters: without a width, 0 times infinity is kMost.
    const auto wanted = static_cast<size_t>(std::min(kMost, event.distance * per_width_));
    const size_t bucket = std::max(wanted, nearest_);
    if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
    buckets_[bucket].push_back(event);
  }

  [[nodiscard]] std::optional<Event> pop() {
    while (nearest_ < buckets_.size() && next_ == buckets_[nearest_].size()) {
      std::vector<Event>().swap(buckets_[nearest_++]);
      next_ = 0;
    }
    if (nearest_ == buckets_.size()) return std::nullopt;
    return buckets_[nearest_][next_++];
  }

 private:
  static constexpr double kMost = 1 << 20;  ///< buckets; the last one takes the rest
  double per_width_;
  size_t nearest_ = 0;  ///< bucket
  size_t next_ = 0;     ///< event in it
  std::vector<std::vector<Event>> buckets_;
};

/// The waves of all sources on the mesh.
///
/// Each source has its own wave, because a triangle that mixes two of them is valid for neither; it
/// ends a little inside the neighbouring cells. Around a corner of the border a wave continues in
/// circles about the corner. Unlike in a march in strict order, a vertex that is reached later on a
/// shorter path is propagated again: in an obtuse triangle the wave may reach one corner before the
/// other two. A longer distance at two corners never makes the third one shorter, so the order of
/// events does not affect the result, except for the circles at the edge of a corner's shadow.
class March {
 public:
  March(const TriangleMesh& mesh, double stop_radius)
      : mesh_(mesh),
        stop_radius_(stop_radius),
        fans_(triangle_fans(mesh)),
        arrivals_(static_cast<size_t>(mesh.vertices.cols())),
        events_(kBucketWidth * mean(fans_.longest)) {}

  void start(const SurfacePoint& at, int source) {
    const Eigen::Vector3d from = position(mesh_, at);
    for (const int corner : mesh_.triangles.col(at.triangle)) {
      const double distance = (mesh_.vertices.col(corner) - from).norm();
      const int known = find(corner, source);
      arrive(corner, source, known, {.distance = distance, .start = 0});
    }
  }

  void run() {
    while (const std::optional<Event> event = events_.pop()) {
      Arrival& arrival = arrivals_[static_cast<size_t>(event->arrival)];
      // Skip the event if a shorter path was found meanwhile.
      if (!arrival.waits || event->distance > arrival.front.distance) continue;
      arrival.waits = false;
      const double edge = fans_.longest[static_cast<size_t>(arrival.vertex)];
      if (arrival.front.distance > stop_radius_ + kBeyondRadius * edge) continue;
      if (arrival.front.distance > nearest_distance(arrival.vertex) + kBeyondCell * edge) continue;
      pass_on(event->arrival);
    }
  }

  [[nodiscard]] GeodesicDistance result() const {
    GeodesicDistance geodesic{
        .distance = Eigen::VectorXd::Constant(mesh_.vertices.cols(), kInfinity),
        .label = Eigen::VectorXi::Constant(mesh_.vertices.cols(), -1)};
    for (int v = 0; v < mesh_.vertices.cols(); ++v) {
      const double nearest = nearest_distance(v);
      if (!(nearest <= stop_radius_) || nearest == kInfinity) continue;
      geodesic.distance[v] = nearest;
      int& label = geodesic.label[v];
      for (int i = v; i != kNone; i = arrivals_[static_cast<size_t>(i)].next) {
        const Arrival& arrival = arrivals_[static_cast<size_t>(i)];
        const bool is_nearest = arrival.front.distance <= nearest * (1 + kEquallyNear);
        if (is_nearest && (label < 0 || arrival.source < label)) label = arrival.source;
      }
    }
    return geodesic;
  }

 private:
  /// The arrival of a source at a vertex, or kNone.
  [[nodiscard]] int find(int vertex, int source) const {
    int i = vertex;
    while (i != kNone && arrivals_[static_cast<size_t>(i)].source != source) {
      i = arrivals_[static_cast<size_t>(i)].next;
    }
    return i;
  }

  [[nodiscard]] double nearest_distance(int vertex) const {
    double nearest = kInfinity;
    for (int i = vertex; i != kNone; i = arrivals_[static_cast<size_t>(i)].next) {
      nearest = std::min(nearest, arrivals_[static_cast<size_t>(i)].front.distance);
    }
    return nearest;
  }

  /// \param known  result of `find`
  void arrive(int vertex, int source, int known, const Front& front) {
    const double distance = front.distance;
    if (known == kNone) {
      const double edge = fans_.longest[static_cast<size_t>(vertex)];
      if (distance > nearest_distance(vertex) + (kBeyondCell + 1) * edge) return;
      known = vertex;
      if (arrivals_[static_cast<size_t>(vertex)].source != kNone) {
        known = static_cast<int>(arrivals_.size());
        arrivals_.push_back({.next = arrivals_[static_cast<size_t>(vertex)].next});
        arrivals_[static_cast<size_t>(vertex)].next = known;
      }
      arrivals_[static_cast<size_t>(known)].source = source;
      arrivals_[static_cast<size_t>(known)].vertex = vertex;
    }
    Arrival& arrival = arrivals_[static_cast<size_t>(known)];
    if (!(distance < arrival.front.distance * (1 - kWorthPassingOn))) return;
    arrival.front = front;
    arrival.waits = true;
    events_.push({.distance = distance, .arrival = known});
  }

  void pass_on(int from) {
    const Front own = arrivals_[static_cast<size_t>(from)].front;
    const int source = arrivals_[static_cast<size_t>(from)].source;
    const auto v = static_cast<size_t>(arrivals_[static_cast<size_t>(from)].vertex);
    const TriangleFans::Neighbour* neighbours =
        &fans_.neighbours[static_cast<size_t>(fans_.first_neighbour[v])];
    const int count = fans_.first_neighbour[v + 1] - fans_.first_neighbour[v];
    reached_.clear();
    for (int i = 0; i < count; ++i) {
      const int known = find(neighbours[i].vertex, source);
      const Arrival arrival = known == kNone ? Arrival{} : arrivals_[static_cast<size_t>(known)];
      reached_.push_back(
          {.arrival = known,
           .settled = known != kNone && !arrival.waits,
           .known = arrival.front,
           .shortest = {.distance = distance_along(own.distance, neighbours[i].squared,
                                                   arrival.front.distance),
                        .start = fans_.turns[v] ? own.distance : own.start}});
    }
    const auto across = [&](const TriangleFans::Corner& corner, int over, int to) {
      const Reached& base = reached_[static_cast<size_t>(over)];
      Reached& target = reached_[static_cast<size_t>(to)];
      if (!base.settled) return;
      const double start = common_start(own, base.known);
      const double known = std::min(target.known.distance, target.shortest.distance);
      const double radius = distance_across(own.distance - start, base.known.distance - start,
                                            neighbours[over].squared, neighbours[to].squared,
                                            corner.dot, corner.cross, known - start);
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
        arrive(neighbours[i].vertex, source, target.arrival, target.shortest);
      }
    }
  }

  /// Knowledge about a neighbour of the vertex that is being propagated.
  struct Reached {
    int arrival;     ///< of the wave; kNone if it has not arrived
    bool settled;    ///< its distance has been propagated, so others may depend on it
    Front known;     ///< infinite if not reached
    Front shortest;  ///< of the paths found now; infinite if none is shorter
  };

  const TriangleMesh& mesh_;
  double stop_radius_;
  TriangleFans fans_;
  std::vector<Arrival> arrivals_;  ///< one for each vertex, then those of further sources
  Events events_;
  std::vector<Reached> reached_;  ///< scratch
};

}  // namespace

GeodesicDistance fast_marching_distance(const TriangleMesh& mesh,
                                        std::span<const SurfacePoint> sources, double stop_radius) {
  March march(mesh, stop_radius);
  for (size_t i = 0; i < sources.size(); ++i) march.start(sources[i], static_cast<int>(i));
  march.run();
  return march.result();
}

}  // namespace palpate::geometry
