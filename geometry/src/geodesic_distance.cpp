// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <queue>
#include <string>
#include <tuple>
#include <vector>

#include "exact_geodesic_distance.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A shorter way is passed on iff it is shorter by more than this fraction: far above rounding, so
/// that the march ends, and far below its accuracy.
constexpr double kWorthPassingOn = 1e-12;

/// Sources whose distances differ by no more than this fraction are equally near; the one with the
/// lowest index gets the vertex. Above what rounding and kWorthPassingOn add up to along a way.
constexpr double kEquallyNear = 1e-9;

/// The first distance of a source at a vertex that the march knows so far.
struct Arrival {
  int source;
  double distance;
};

/// An arrival that waits to be passed on. The nearest goes first; the rest makes the order unique.
struct Event {
  double distance;
  int vertex;
  int source;
  bool operator>(const Event& other) const {
    return std::tie(distance, vertex, source) >
           std::tie(other.distance, other.vertex, other.source);
  }
};

/// Distance at corner `c` of a wave that passed the corners `a` and `b` at the given distances: the
/// triangle is laid in a plane, a = (0, 0), b = (length, 0), c above; the wave came from the point
/// below that is as far from `a` and `b` as they say. Infinite if the straight line from there to
/// `c` misses the edge: the shortest way then runs along an edge, or through another triangle.
double distance_across(const Eigen::Vector3d& a, double distance_a, const Eigen::Vector3d& b,
                       double distance_b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const double length = ab.norm();
  const double difference = distance_a - distance_b;
  if (!(std::abs(difference) <= length) || length == 0) return kInfinity;
  const double c_x = ac.dot(ab) / length;
  const double c_y = ab.cross(ac).norm() / length;
  const double source_x = (difference * (distance_a + distance_b) / length + length) / 2;
  // Negative by rounding where the source is on the edge.
  const double depth = std::sqrt(std::max(0.0, (distance_a - source_x) * (distance_a + source_x)));
  if (!(c_y + depth > 0)) return kInfinity;
  const double crossing_x = source_x + (c_x - source_x) * depth / (c_y + depth);
  if (!(crossing_x >= 0 && crossing_x <= length)) return kInfinity;
  return std::hypot(c_x - source_x, c_y + depth);
}

/// The waves of all sources on their way over the mesh. Each source has a wave of its own, because
/// a triangle that mixes two of them says nothing about either; it ends a little way inside its
/// neighbours' cells. A vertex that is reached on a shorter way later is passed on again (as a
/// march in strict order would not): in an obtuse triangle the wave may get to a corner before it
/// has been at the two that it came between.
class March {
 public:
  March(const TriangleMesh& mesh, double stop_radius)
      : mesh_(mesh),
        stop_radius_(stop_radius),
        first_(static_cast<size_t>(mesh.vertices.cols()) + 1, 0),
        longest_edge_(Eigen::VectorXd::Zero(mesh.vertices.cols())),
        arrivals_(static_cast<size_t>(mesh.vertices.cols())) {
    list_triangles_of_vertices();
    measure_edges();
  }

  void start(const SurfacePoint& at, int source) {
    const Eigen::Vector3d from = position(mesh_, at);
    for (const int corner : mesh_.triangles.col(at.triangle)) {
      arrive(corner, source, (mesh_.vertices.col(corner) - from).norm());
    }
  }

  void run() {
    while (!events_.empty()) {
      const Event event = events_.top();
      events_.pop();
      // Superseded by a shorter way meanwhile?
      if (event.distance > distance(event.vertex, event.source)) continue;
      if (is_needed(event)) pass_on(event);
    }
  }

  [[nodiscard]] GeodesicDistance result() const {
    GeodesicDistance geodesic{
        .distance = Eigen::VectorXd::Constant(mesh_.vertices.cols(), kInfinity),
        .label = Eigen::VectorXi::Constant(mesh_.vertices.cols(), -1)};
    for (Eigen::Index v = 0; v < mesh_.vertices.cols(); ++v) {
      const double nearest = nearest_distance(static_cast<int>(v));
      if (!(nearest <= stop_radius_)) continue;
      geodesic.distance[v] = nearest;
      int& label = geodesic.label[v];
      for (const Arrival& arrival : arrivals_[static_cast<size_t>(v)]) {
        const bool is_nearest = arrival.distance <= nearest * (1 + kEquallyNear);
        if (is_nearest && (label < 0 || arrival.source < label)) label = arrival.source;
      }
    }
    return geodesic;
  }

 private:
  void list_triangles_of_vertices() {
    for (const int corner : mesh_.triangles.reshaped()) ++first_[static_cast<size_t>(corner) + 1];
    for (size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    triangles_.resize(static_cast<size_t>(mesh_.triangles.size()));
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (Eigen::Index t = 0; t < mesh_.triangles.cols(); ++t) {
      for (const int corner : mesh_.triangles.col(t)) {
        triangles_[static_cast<size_t>(next[static_cast<size_t>(corner)]++)] = static_cast<int>(t);
      }
    }
  }

  void measure_edges() {
    for (const auto& corners : mesh_.triangles.colwise()) {
      for (int k = 0; k < 3; ++k) {
        const int a = corners[k];
        const int b = corners[(k + 1) % 3];
        const double length = (mesh_.vertices.col(b) - mesh_.vertices.col(a)).norm();
        longest_edge_[a] = std::max(longest_edge_[a], length);
        longest_edge_[b] = std::max(longest_edge_[b], length);
      }
    }
  }

  [[nodiscard]] double distance(int vertex, int source) const {
    for (const Arrival& arrival : arrivals_[static_cast<size_t>(vertex)]) {
      if (arrival.source == source) return arrival.distance;
    }
    return kInfinity;
  }

  [[nodiscard]] double nearest_distance(int vertex) const {
    double nearest = kInfinity;
    for (const Arrival& arrival : arrivals_[static_cast<size_t>(vertex)]) {
      nearest = std::min(nearest, arrival.distance);
    }
    return nearest;
  }

  /// A vertex of a cell has neighbours outside that its distance may depend on: by the triangle
  /// inequality they are at most two edges further from the cell's source than from their own, and
  /// one edge beyond the radius. In obtuse triangles those depend on one more.
  [[nodiscard]] bool is_needed(const Event& event) const {
    const double edge = longest_edge_[event.vertex];
    return event.distance <= nearest_distance(event.vertex) + 3 * edge &&
           event.distance <= stop_radius_ + 2 * edge;
  }

  void arrive(int vertex, int source, double distance) {
    std::vector<Arrival>& here = arrivals_[static_cast<size_t>(vertex)];
    auto known = std::ranges::find(here, source, &Arrival::source);
    if (known == here.end()) {
      here.push_back({.source = source, .distance = distance});
    } else if (distance < known->distance * (1 - kWorthPassingOn)) {
      known->distance = distance;
    } else {
      return;
    }
    events_.push({.distance = distance, .vertex = vertex, .source = source});
  }

  void pass_on(const Event& event) {
    const auto of_vertex = static_cast<size_t>(event.vertex);
    for (int i = first_[of_vertex]; i < first_[of_vertex + 1]; ++i) {
      const Eigen::Vector3i corners = mesh_.triangles.col(triangles_[static_cast<size_t>(i)]);
      const int k = corners[0] == event.vertex ? 0 : corners[1] == event.vertex ? 1 : 2;
      pass_on_to(corners[(k + 1) % 3], corners[(k + 2) % 3], event);
      pass_on_to(corners[(k + 2) % 3], corners[(k + 1) % 3], event);
    }
  }

  /// From event's vertex to `c`, along the edge or across the edge to `b`.
  void pass_on_to(int c, int b, const Event& event) {
    const Eigen::Vector3d from = mesh_.vertices.col(event.vertex);
    const Eigen::Vector3d to = mesh_.vertices.col(c);
    double shortest = event.distance + (to - from).norm();
    const double distance_b = distance(b, event.source);
    if (distance_b < kInfinity) {
      shortest = std::min(
          shortest, distance_across(from, event.distance, mesh_.vertices.col(b), distance_b, to));
    }
    arrive(c, event.source, shortest);
  }

  const TriangleMesh& mesh_;
  double stop_radius_;
  std::vector<int> first_;      ///< V + 1: where a vertex's triangles begin in `triangles_`
  std::vector<int> triangles_;  ///< of one vertex after the other
  Eigen::VectorXd longest_edge_;
  std::vector<std::vector<Arrival>> arrivals_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
};

}  // namespace

GeodesicDistance geodesic_distance(const TriangleMesh& mesh, std::span<const SurfacePoint> sources,
                                   const GeodesicOptions& options) {
  if (!(options.stop_radius > 0)) {
    throw InvalidInput("geodesic_distance: stop_radius is " + std::to_string(options.stop_radius) +
                       " mm; it must be > 0");
  }
  check_mesh(mesh, "geodesic_distance");
  if (sources.empty()) {
    throw InvalidInput("geodesic_distance: there is no source; pass at least one");
  }
  for (size_t i = 0; i < sources.size(); ++i) {
    const std::string what = "geodesic_distance: source " + std::to_string(i);
    check_surface_point(mesh, sources[i], what.c_str());
  }
  if (options.method == GeodesicMethod::exact) {
    return exact_geodesic_distance(mesh, sources, options.stop_radius);
  }
  March march(mesh, options.stop_radius);
  for (size_t i = 0; i < sources.size(); ++i) march.start(sources[i], static_cast<int>(i));
  march.run();
  return march.result();
}

}  // namespace palpate::geometry
