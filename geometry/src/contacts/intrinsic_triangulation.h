// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "base/numbers.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A surface given only by the connectivity of its triangles and their edge lengths; it can be
/// flipped and coarsened without an embedding. Two triangles may share several edges, and an edge
/// may begin and end in the same vertex (a Delta-complex). Half-edge 3 t + k runs from corner k of
/// triangle t to its corner (k + 1) % 3, as in mesh_topology.h.
///
/// An id is a vertex or a tracked point. A tracked point lies in a triangle, and its barycentric
/// coordinates follow every change. Lengths are in units of the mean edge length of the original
/// mesh.
class IntrinsicTriangulation {
 public:
  /// Ids 0 .. V - 1 are the vertices of the mesh. A vertex where several fans of triangles touch
  /// becomes one vertex per fan; the additional ones get ids from V on (see `fan_of`).
  /// \throws InvalidInput if more than two triangles share an edge, or two of opposite orientation.
  explicit IntrinsicTriangulation(const TriangleMesh& mesh);

  /// Prepares the surface for all that follows, when points may be tracked already. Collapses edges
  /// without length, as far as the surface stays a manifold; the vertex that goes becomes a tracked
  /// point. Then lengthens all edges slightly if a triangle has no area (mollification; Sharp and
  /// Crane 2020).
  void remove_degenerate_triangles();

  /// Flipping to Delaunay needs a few flips per edge; after this many it stops, in case rounding
  /// makes it cycle.
  static constexpr size_t kFlipsPerEdge = 100;
  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }

  [[nodiscard]] int from(int h) const { return triangle(h).corner[static_cast<size_t>(h % 3)]; }
  [[nodiscard]] int to(int h) const { return from(next(h)); }
  [[nodiscard]] int opposite(int h) const {
    return triangle(h).opposite[static_cast<size_t>(h % 3)];
  }
  [[nodiscard]] double length(int h) const {
    return triangle(h).length[static_cast<size_t>(h % 3)];
  }
  [[nodiscard]] double unit() const { return unit_; }  ///< [mm] length of one unit
  [[nodiscard]] int triangle_slots() const { return static_cast<int>(triangles_.size()); }
  [[nodiscard]] bool is_alive(int t) const {
    return triangles_[static_cast<size_t>(t)].corner[0] >= 0;
  }
  [[nodiscard]] int id_count() const { return static_cast<int>(out_.size()); }
  [[nodiscard]] bool is_vertex(int id) const { return out_[static_cast<size_t>(id)] != kNone; }
  [[nodiscard]] bool is_boundary(int v) const { return boundary_[static_cast<size_t>(v)] != 0; }
  /// For an id from V on, the mesh vertex of which it is an additional fan; for others the id
  /// itself.
  [[nodiscard]] int fan_of(int id) const { return fan_of_[static_cast<size_t>(id)]; }
  /// A half-edge that leaves the vertex; at the border the first one counter-clockwise.
  [[nodiscard]] int out(int v) const { return out_[static_cast<size_t>(v)]; }

  /// The half-edges that leave a vertex, counter-clockwise.
  void fan(int v, std::vector<int>& half_edges) const;

  /// Returns true if two vertices are joined by an edge.
  [[nodiscard]] bool are_joined(int a, int b) const;
  /// Returns true if a flip would duplicate an existing edge or join a vertex to itself.
  [[nodiscard]] bool flip_repeats_edge(int h) const {
    const int c = from(previous(h));
    const int d = from(previous(opposite(h)));
    return c == d || are_joined(c, d);
  }

  /// Adds a tracked point; barycentric coordinates must be >= 0 and sum to 1.
  int track(int t, const Eigen::Vector3d& barycentric);
  [[nodiscard]] int triangle_of_point(int id) const {
    return points_[static_cast<size_t>(id)].triangle;
  }
  [[nodiscard]] const Eigen::Vector3d& barycentric(int id) const {
    return points_[static_cast<size_t>(id)].barycentric;
  }
  /// The tracked points of a triangle, as a linked list that ends with kNone.
  [[nodiscard]] int first_point(int t) const {
    return triangles_[static_cast<size_t>(t)].first_point;
  }
  [[nodiscard]] int next_point(int id) const { return points_[static_cast<size_t>(id)].next; }

  /// Turns a tracked point into a vertex that splits its triangle, or its edge if it lies on one
  /// (within rounding); existing lengths do not change.
  void make_vertex(int id);

  /// Returns true if the angles opposite an edge sum to at most pi, within rounding.
  [[nodiscard]] bool is_delaunay(int h) const;
  /// Exchanges the diagonal of the two triangles at an edge. Returns false without a change if the
  /// quadrilateral is not strictly convex or the edge has only one triangle.
  bool flip(int h);
  /// Flips until every edge is Delaunay, starting with the given edges and following those affected
  /// by a flip (Lawson 1977); `may_flip` can forbid flips. Always terminates.
  template <typename MayFlip>
  void flip_to_delaunay(std::vector<int>& half_edges, const MayFlip& may_flip) {
    size_t left = kFlipsPerEdge * (half_edges.size() + kFlipsPerEdge);
    while (!half_edges.empty() && left > 0) {
      const int h = half_edges.back();
      half_edges.pop_back();
      if (!is_alive(h / 3) || opposite(h) == kNone || is_delaunay(h) || !may_flip(h)) continue;
      const int t = h / 3;
      const int other = opposite(h) / 3;
      if (!flip(h)) continue;
      --left;
      half_edges.insert(half_edges.end(), {3 * t + 1, 3 * t + 2, 3 * other + 1, 3 * other + 2});
    }
    half_edges.clear();
  }
  void flip_to_delaunay(std::vector<int>& half_edges) {
    flip_to_delaunay(half_edges, [](int) { return true; });
  }

  /// A polygon of triangles laid out in the plane, to be retriangulated. A node is a corner of it;
  /// several nodes may be the same vertex.
  struct Patch {
    struct Node {
      int vertex;
      Eigen::Vector2d position;
    };
    using Triangle = std::array<int, 3>;  ///< nodes, counter-clockwise
    std::vector<Node> nodes;
    std::vector<int> old_triangles;
    std::vector<Triangle> old_nodes;  ///< of each old triangle, starting at its corner 0
    std::vector<Triangle> new_nodes;  ///< of the new triangles
    std::vector<int> new_triangles;   ///< output of `replace`
  };
  /// Replaces the old triangles of the patch by the new ones. Edges that remain keep their length,
  /// and points their position. A new edge on the rim is a border edge.
  void replace(Patch& patch);
  /// Turns a vertex without triangles into a tracked point at the origin of the patch.
  void retire_vertex(int v, const Patch& patch);

 private:
  struct Triangle {  // one cache line
    std::array<double, 3> length;
    std::array<int, 3> corner;
    std::array<int, 3> opposite;
    int first_point;
  };
  struct Point {
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
    int triangle = kNone;
    int next = kNone;
  };
  struct RimEdge {
    std::array<int, 2> nodes;
    int old_half_edge;
    int opposite;
    double length;
    int new_half_edge;
  };

  [[nodiscard]] const Triangle& triangle(int h) const {
    return triangles_[static_cast<size_t>(h / 3)];
  }
  [[nodiscard]] bool has_no_length(int h) const;
  [[nodiscard]] bool may_collapse(int h) const;
  bool collapse(int h);
  /// The first half-edge counter-clockwise around the vertex that `begin` leaves; `begin` itself if
  /// the fan is closed.
  [[nodiscard]] int first_of_fan(int begin) const;
  int add_id();
  void separate_fans(int vertex_count);
  void measure(const TriangleMesh& mesh);
  void push_point(int id, int t);
  void unlink_point(int id);
  void glue(int h, int other);
  void update_out(int t);
  void list_rim(const Patch& patch);
  void glue_patch(const Patch& patch);
  void place_point(int id, const Eigen::Vector2d& at, const Patch& patch);

  std::vector<Triangle> triangles_;
  std::vector<Point> points_;
  std::vector<int> out_;
  std::vector<int> fan_of_;
  std::vector<char> boundary_;
  std::vector<int> free_;
  std::vector<RimEdge> rim_;                             // scratch
  std::vector<std::pair<int, Eigen::Vector2d>> moving_;  // scratch
  Patch split_;                                          // scratch
  double unit_ = 1;
};

}  // namespace palpate::geometry
