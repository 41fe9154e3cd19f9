// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh/triangle_primitives.h"
#include "palpate/geometry/triangle_mesh.h"
#include "query/bounding_tree.h"

namespace palpate::geometry {

/// The nearest triangle; -1 if there is none.
struct NearestTriangle {
  Nearest at;
  int triangle = -1;
  int place = -1;  ///< in the tree: kSize * packet + lane
};

/// The nearest triangle, and how far away all others are.
struct LoneNearest {
  NearestTriangle nearest;
  double others = 0;  ///< no other triangle is nearer than this
};

/// A triangle crossed by a segment; -1 if there is none.
struct CrossedTriangle {
  Crossing at;
  int triangle = -1;
  int place = -1;  ///< in the tree: kSize * packet + lane
};

/// A mesh in its local frame (centred on its bounding box and scaled by a power of two to [-1, 1],
/// which is exact) with a tree of boxes slightly larger than the triangles.
///
/// Boxes and packets of triangles cull in single precision, or for closest points from far away in
/// double; the nearest or first triangle is decided in double. Among equals the lowest index wins,
/// so the traversal order does not matter.
class SurfaceTree {
 public:
  /// Precondition: the mesh is valid.
  /// \throws SolverError if Embree fails.
  explicit SurfaceTree(const TriangleMesh& mesh, TreeBuild build = TreeBuild::thorough);

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  /// local = (world - centre) * scale; a power of two
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] Eigen::Vector3d to_local(const Eigen::Vector3d& world) const {
    return (world - centre_) * scale_;
  }

  /// The point of the triangle at a place of the tree; in the frame of the mesh.
  [[nodiscard]] Eigen::Vector3d position(int place, const Eigen::Vector3d& barycentric) const {
    return point_on(corners(place), barycentric);
  }

  /// Moves all vertices. Precondition: as many as before, all finite.
  /// \throws SolverError if Embree fails to rebuild the tree.
  void move_vertices(const Eigen::Ref<const Eigen::Matrix3Xd>& vertices);

  /// Nearest point within `radius` (or slightly beyond), local frame.
  [[nodiscard]] NearestTriangle nearest(const Eigen::Vector3d& point, double radius) const noexcept;

  /// Nearest point at any distance, local frame, and the distance of the second nearest triangle if
  /// this is at most `slack` farther away. The answer does not depend on the guess.
  /// \param guess place of a triangle near the point, which shortens the search; -1 if none is
  /// known.
  [[nodiscard]] LoneNearest lone_nearest(const Eigen::Vector3d& point, int guess,
                                         double slack) const noexcept;

  /// The triangle at a place of the tree, local frame.
  [[nodiscard]] Corners local_corners(int place) const {
    const auto& [a, b, c] = corners(place);
    return {to_local(a), to_local(b), to_local(c)};
  }
  [[nodiscard]] int triangle_at(int place) const {
    constexpr int kSize = TrianglePacket::kSize;
    return tree_.packets[static_cast<std::size_t>(place / kSize)]
        .triangle[static_cast<std::size_t>(place % kSize)];
  }

  /// First crossing of a segment, local frame. An end within rounding of the surface is a crossing:
  /// the start precedes all others; the end counts if there is no other. Precondition: within
  /// [-2, 2].
  [[nodiscard]] CrossedTriangle first_crossing(const Eigen::Vector3d& start,
                                               const Eigen::Vector3d& end) const noexcept;

  /// All crossings of a segment, local frame, sorted by fraction and then by triangle. The segment
  /// counts as shifted sideways by an infinitesimal distance, so that it meets no edge and no
  /// vertex. A triangle that it would cross beyond an end within rounding of the triangle is
  /// crossed at that end. Precondition: within [-2, 2].
  [[nodiscard]] std::vector<CrossedTriangle> all_crossings(const Eigen::Vector3d& start,
                                                           const Eigen::Vector3d& end) const;

 private:
  /// Returns the vertices in the local frame.
  [[nodiscard]] Eigen::Matrix3Xd set_frame();
  void build(const Eigen::Matrix3Xd& local);
  void set_corners();
  [[nodiscard]] Corners corners(int place) const {
    if (!corners_.empty()) return corners_[static_cast<std::size_t>(place)];
    const auto named = mesh_.triangles.col(triangle_at(place));
    return {mesh_.vertices.col(named[0]), mesh_.vertices.col(named[1]),
            mesh_.vertices.col(named[2])};
  }
  struct FoundNearest;
  template <typename Number>
  struct NearestSearch;
  struct CrossingSearch;
  [[nodiscard]] FoundNearest find(const Eigen::Vector3d& point, int guess, double radius,
                                  double slack) const;
  template <typename Number>
  [[nodiscard]] FoundNearest find(const Eigen::Vector3d& point, int guess, double radius,
                                  double slack) const;
  [[nodiscard]] FoundNearest find_from_beyond(const Eigen::Vector3d& point, int guess,
                                              double radius, double slack) const;
  template <typename Number>
  void look_at(NearestSearch<Number>& search, int number) const;
  void look_at(CrossingSearch& search, int number) const;
  [[nodiscard]] const TrianglePacket& start_packet(int number) const;
  void touch(NearestTriangle& nearest, const Eigen::Vector3d& end, int triangle, int place) const;
  [[nodiscard]] bool touches(const Eigen::Vector3d& end, int place) const;

  TriangleMesh mesh_;
  TreeBuild build_;
  Eigen::Vector3d centre_;
  double scale_ = 1;
  double on_surface_ = 0;  ///< ends closer than this are on the surface; local frame
  double margin_ = 0;      ///< covers rounding in single precision and `on_surface_`
  /// The corners of the triangle at each place of the tree, because gathering them from the mesh
  /// would mean waiting for memory twice more. Empty in a quick tree.
  std::vector<Corners, HugePages<Corners>> corners_;
  BoundingTree tree_;
  double built_cost_ = 0;  ///< traversal cost of the tree when it was built
};

}  // namespace palpate::geometry
