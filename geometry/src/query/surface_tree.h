// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "mesh/triangle_primitives.h"
#include "palpate/geometry/triangle_mesh.h"
#include "query/bounding_tree.h"

namespace palpate::geometry {

/// The nearest triangle; -1 if there is none.
struct NearestTriangle {
  Nearest at;
  int triangle = -1;
};

/// A triangle that a segment crosses; -1 if there is none.
struct CrossedTriangle {
  Crossing at;
  int triangle = -1;
};

/// A mesh in its local frame, centred on its bounding box and scaled by a power of two to [-1, 1],
/// which costs no precision, under a tree of boxes a little larger than the triangles.
///
/// Boxes and packets of triangles cull in single precision; which triangle is nearest or first is
/// decided in double. Of equals the lowest index wins, so the order of visits does not matter.
class SurfaceTree {
 public:
  /// Pre: the mesh is valid. \throws SolverError if Embree fails.
  explicit SurfaceTree(const TriangleMesh& mesh);

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  /// local = (world - centre) * scale; a power of two
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] Eigen::Vector3d to_local(const Eigen::Vector3d& world) const {
    return (world - centre_) * scale_;
  }

  /// All vertices elsewhere. Pre: as many as before, finite.
  /// \throws SolverError if Embree fails to build anew.
  void move_vertices(const Eigen::Ref<const Eigen::Matrix3Xd>& vertices);

  /// Nearest point no further than `radius` (or a little further), local frame.
  [[nodiscard]] NearestTriangle nearest(const Eigen::Vector3d& point, double radius) const noexcept;

  /// First crossing of a segment, local frame. An end within rounding of the surface is a crossing,
  /// the start the first one before all others, the end if there is no other. Pre: within [-2, 2].
  [[nodiscard]] CrossedTriangle first_crossing(const Eigen::Vector3d& start,
                                               const Eigen::Vector3d& end) const noexcept;

 private:
  void set_frame();
  void build();
  [[nodiscard]] Corners corners(int triangle) const {
    const Eigen::Vector3i of = mesh_.triangles.col(triangle);
    return {local_.col(of[0]), local_.col(of[1]), local_.col(of[2])};
  }
  struct NearestSearch;
  struct CrossingSearch;
  void look_at(NearestSearch& search, const TrianglePacket& packet) const;
  void look_at(CrossingSearch& search, const TrianglePacket& packet) const;
  void touch(NearestTriangle& nearest, const Eigen::Vector3d& end, int triangle) const;

  TriangleMesh mesh_;
  Eigen::Vector3d centre_;
  double scale_ = 1;
  Eigen::Matrix3Xd local_;
  double on_surface_ = 0;  ///< an end no further from the surface is on it; local frame
  double margin_ = 0;  ///< for rounding in single precision, and to reach what is on the surface
  BoundingTree tree_;
  double built_cost_ = 0;  ///< of walking the tree when it was built
};

}  // namespace palpate::geometry
