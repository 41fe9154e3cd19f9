// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A surface whose edges can be split, collapsed and flipped. Half-edge 3 t + k runs from corner k
/// of triangle t to the next one, as in `opposite_half_edges`.
class EditableMesh {
 public:
  /// Precondition: the edges are manifold.
  /// \throws InvalidInput naming `what` and a vertex at which several fans of triangles meet.
  EditableMesh(const TriangleMesh& mesh, const char* what);

  [[nodiscard]] static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  [[nodiscard]] static int last(int h) { return h % 3 == 0 ? h + 2 : h - 1; }

  [[nodiscard]] int half_edge_count() const { return static_cast<int>(start_.size()); }
  [[nodiscard]] int vertex_count() const { return static_cast<int>(positions_.size()); }
  [[nodiscard]] int triangle_count() const { return live_; }  ///< without those that are removed
  [[nodiscard]] bool is_live(int h) const { return start_[size(h)] >= 0; }
  [[nodiscard]] bool is_vertex_live(int v) const { return leaving_[size(v)] >= 0; }
  [[nodiscard]] int start(int h) const { return start_[size(h)]; }
  [[nodiscard]] int end(int h) const { return start_[size(next(h))]; }
  [[nodiscard]] int apex(int h) const { return start_[size(last(h))]; }
  [[nodiscard]] int opposite(int h) const { return opposite_[size(h)]; }  ///< -1 at the border
  [[nodiscard]] const Eigen::Vector3d& at(int v) const { return positions_[size(v)]; }
  void move(int v, const Eigen::Vector3d& to) { positions_[size(v)] = to; }
  [[nodiscard]] double length(int h) const { return (at(end(h)) - at(start(h))).norm(); }

  [[nodiscard]] bool is_feature(int h) const { return feature_[size(h)] != 0; }
  void make_feature(int h);

  /// Calls `act` with each half-edge that leaves a vertex, counter-clockwise; at the border from
  /// the first to the last triangle.
  void each_leaving(int v, auto&& act) const {
    const int first = leaving_[size(v)];
    if (first < 0) return;
    int h = first;
    do {
      act(h);
      h = opposite_[size(last(h))];
    } while (h >= 0 && h != first);
  }
  [[nodiscard]] bool is_on_border(int v) const { return opposite_[size(leaving_[size(v)])] < 0; }

  /// The neighbours of a vertex, each once.
  void neighbours(int v, std::vector<int>& found) const;
  [[nodiscard]] bool are_neighbours(int v, int w) const;

  /// Cuts an edge in its middle. \return the new vertex
  int split(int h);
  /// Returns true if an edge can be flipped so that the surface stays a manifold.
  [[nodiscard]] bool can_flip(int h) const;
  /// Replaces an inner edge by the other diagonal of its two triangles.
  void flip(int h);
  /// Returns true if an edge can shrink to one vertex so that the surface stays a manifold.
  [[nodiscard]] bool can_collapse(int h);
  /// Removes the start of a half-edge; its end takes its place.
  void collapse(int h);

  /// The triangles that are left, with the vertices that they use.
  [[nodiscard]] TriangleMesh mesh() const;

 private:
  [[nodiscard]] static size_t size(int i) { return static_cast<size_t>(i); }
  void join(int h, int g);
  /// Lets a vertex begin with the first triangle of its fan. \param h leaves it
  void begin_fan(int h);
  void take(int h, int from);
  int close(int h);

  std::vector<Eigen::Vector3d> positions_;
  std::vector<int> start_, opposite_;
  std::vector<char> feature_;
  std::vector<int> leaving_;  ///< of each vertex; the first of its fan; -1 without triangles
  int live_ = 0;
  std::vector<int> around_[2];  ///< scratch
};

}  // namespace palpate::geometry
