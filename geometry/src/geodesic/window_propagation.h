// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "base/numbers.h"
#include "geodesic/bucket_queue.h"
#include "geodesic/edge_windows.h"
#include "geodesic/flat_triangles.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The windows of all sources on the mesh (Mitchell, Mount and Papadimitriou 1987), passed on in
/// buckets of the distance. Windows that come too early within a bucket are corrected later, so the
/// order there has no effect on the result beyond rounding. An edge is finished when the buckets of
/// all windows that could be nearer are done.
class WindowPropagation {
 public:
  /// `flat` must outlive the propagation; lengths are in its unit.
  WindowPropagation(const FlatTriangles& flat, double stop_radius);

  void start(const SurfacePoint& at, int source);

  /// Passes all windows on, up to the radius. Windows that no later path can replace are dropped,
  /// so memory grows with the wave front, not with the mesh.
  /// \param progress see `GeodesicOptions`; may be empty.
  void run(const std::function<void(int done, int total)>& progress);

  /// Passes windows on until those that arrive are farther than each of the targets.
  void run_to(std::span<const SurfacePoint> targets);

  [[nodiscard]] double distance(int vertex) const { return distance_[static_cast<size_t>(vertex)]; }
  [[nodiscard]] int source(int vertex) const { return source_[static_cast<size_t>(vertex)]; }

  /// The windows of an edge, sorted and without overlap, in the direction of the edge.
  [[nodiscard]] const std::vector<Window>& windows(int edge) const { return windows_.of(edge); }

 private:
  enum class ArrivalAt {
    half_edge,  ///< which has windows to be passed on
    vertex,     ///< at which paths bend
    whole_edge  ///< to which nothing nearer can come
  };
  struct Arrival {
    double distance;
    int index;
    ArrivalAt at;
  };

  /// Takes the next arrival. \return true if there was one
  bool step();
  /// \return true if no path to the vertex was as short
  bool improve(int vertex, double distance, int source);
  void reach(int vertex, double distance, int source);
  void expect(int half_edge, double distance);
  void expect_edges_at(int vertex);
  void start_in(int triangle, const Eigen::Vector3d& weights, int source);
  void spread(int vertex);
  void leave(int half_edge, const Eigen::Vector2d& point, double start, int source);
  void add(int h, const Window& window);
  void pass_on(int h, double farthest);
  void cross(int h, const Window& window);
  static Window hitting_window(const Window& window, const Eigen::Vector2d& direction,
                               double length, bool reaches_end);
  [[nodiscard]] bool is_longer_than_through(int vertex, const FlatHalfEdge& crossed,
                                            const Eigen::Vector2d& direction,
                                            const Window& hitting) const;

  const FlatTriangles& flat_;
  double stop_radius_;
  double together_;
  std::vector<double> distance_;  ///< of each vertex
  int reached_ = 0;               ///< number of vertices
  std::vector<int> source_;       ///< of each vertex
  std::vector<char> bends_;       ///< nonzero if paths can bend at a vertex
  EdgeWindows windows_;
  bool keeps_windows_ = true;
  std::vector<double> expected_;  ///< of each half-edge: distance of the arrival that counts
  BucketQueue<Arrival> arrivals_;
};

}  // namespace palpate::geometry
