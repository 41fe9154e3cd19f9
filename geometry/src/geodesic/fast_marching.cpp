// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/geodesic_methods.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "mesh/triangle_fans.h"

namespace palpate::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kNone = -1;

/// A shorter way is passed on iff its square is shorter by more than this fraction: far above
/// rounding, so that the march ends, and far below its accuracy.
constexpr double kWorthPassingOn = 2e-12;

/// Sources whose distances differ by no more than this fraction are equally near; the one with the
/// lowest index gets the vertex. Above what rounding and kWorthPassingOn add up to along a way.
constexpr double kEquallyNear = 1e-9;

/// A wave is passed on as far beyond its cell, in lengths of the longest edge at a vertex: its
/// distances inside the cell are built on those of neighbours outside. Further than this is not
/// felt in the labels.
constexpr double kBeyondCell = 1;

/// The same beyond the radius, where nothing is at hand to put a label right.
constexpr double kBeyondRadius = 3;

/// Width of a bucket of events in lengths of the mean longest edge: short enough that few vertices
/// are passed on too early.
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

/// Distance at corner `c` of a wave that passed the corners `a` and `b` at the given distances: the
/// triangle is laid in a plane, a = (0, 0), b = (e, 0), c above; the wave came from the point S
/// below that is as far from `a` and `b` as they say. With the foot of S at u e, its depth y,
/// and c = (c_x, c_y):
///   2 u = (d_a^2 - d_b^2) / e^2 + 1
///   4 e^2 y^2 = ((d_a + d_b)^2 - e^2) (e^2 - (d_a - d_b)^2)
///   d_c^2 = d_a^2 + |ac|^2 - 2 u e c_x + 2 y c_y
/// Infinite if d_c is not shorter than `known`, which is found out without a square root, or if the
/// straight line from S to `c` misses the edge: the shortest way then runs along an edge, or
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
  // Where the line crosses the edge, times positive factors: not before `a`, not behind `b`.
  if (!(twice_foot * cross + dot * depth >= 0)) return kInfinity;
  if (!((twice_foot - 2) * cross + (dot - edge) * depth <= 0)) return kInfinity;
  return std::sqrt(without_depth + depth);
}

/// A wave at a vertex.
struct Front {
  double distance = kInfinity;
  double start = 0;  ///< distance at the centre of the circle that it is on: 0, or of a corner
};

/// The start of the circle through two points, one of which may have been reached past a corner
/// that the other is not hidden behind. Equal weights flatten the front behind the corner, and
/// weights in proportion to the curvatures bend it too much; halfway between, most of both errors
/// is gone.
double common_start(const Front& a, const Front& b) {
  if (a.start == b.start) return a.start;
  const double radius_a = a.distance - a.start;
  const double radius_b = b.distance - b.start;
  const double even = 0.5 * (a.start + b.start);
  const double weighted = (a.start * radius_b + b.start * radius_a) / (radius_a + radius_b);
  return 0.5 * (even + weighted);
}

/// The first distance of one source at one vertex that the march knows so far.
struct Arrival {
  Front front = {};
  int source = kNone;
  int next = kNone;  ///< arrival of another source at the same vertex
  int vertex = kNone;
  bool waits = false;  ///< to be passed on
};

struct Event {
  double distance;
  int arrival;
};

/// Arrivals that wait, the nearest first, but in a bucket as they came. That is enough for a march
/// that corrects what was passed on too early, takes no time to sort, and leaves neighbours
/// together.
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

/// The waves of all sources on their way over the mesh. Each source has a wave of its own, because
/// a triangle that mixes two of them says nothing about either; it ends a little way inside its
/// neighbours' cells. Past a corner of a border a wave goes on in circles about the corner. A
/// vertex that is reached on a shorter way later is passed on again (as a march in strict order
/// would not): in an obtuse triangle the wave may get to a corner before it has been at the two
/// that it came between. Distances at two corners never make a third shorter by being longer, so
/// the order of events does not matter to the outcome, but for how much of a corner's circles is
/// felt at the edge of what it hides.
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
      // Superseded by a shorter way meanwhile?
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

  /// \param known  what find says
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

  /// What a vertex that passes its wave on knows of a neighbour.
  struct Reached {
    int arrival;     ///< of the wave; kNone = not yet
    bool settled;    ///< its distance has been passed on, so that others may build on it
    Front known;     ///< infinite if not reached
    Front shortest;  ///< of the ways found now; infinite if none is shorter
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
