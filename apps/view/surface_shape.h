// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/deformed_shape.h"

namespace palpate::view {

/// Vertices from `begin` to before `end`.
struct VertexRange {
  Eigen::Index begin = 0, end = 0;
};

/// A surface as it is drawn: positions and smooth normals in single precision, and which vertices
/// have moved. A dent costs what the vertices near it cost, however large the surface is.
class SurfaceShape {
 public:
  /// At rest. \throws InvalidInput if the mesh is not valid.
  explicit SurfaceShape(geometry::TriangleMesh surface);

  /// Draws the surface as `haptics::drawn_shape` does. \return the vertices that changed, with some
  /// others among them.
  VertexRange deform(const geometry::SurfacePoint& contact, const Eigen::Vector3d& displacement,
                     const haptics::DrawnShapeOptions& options);
  /// Draws the surface with vertices at other places, 3 x V [mm].
  VertexRange show(const Eigen::Matrix3Xd& vertices);
  /// Back to rest.
  VertexRange rest();

  [[nodiscard]] const geometry::TriangleMesh& surface() const { return surface_; }
  [[nodiscard]] const Eigen::Matrix3Xf& positions() const { return positions_; }
  /// Unit; zero where no triangle has an area.
  [[nodiscard]] const Eigen::Matrix3Xf& normals() const { return normals_; }
  /// [mm] that vertices moved, V.
  [[nodiscard]] const Eigen::VectorXf& moved() const { return moved_; }

 private:
  [[nodiscard]] std::vector<int> near(const geometry::SurfacePoint& contact, double radius);
  void update_normals(const std::vector<int>& vertices);
  void restore();

  geometry::TriangleMesh surface_;
  std::vector<int> first_,
      fans_;                 // triangles of vertex v: fans_[first_[v]] to fans_[first_[v + 1]]
  double longest_edge_ = 0;  // [mm]
  Eigen::Matrix3Xf positions_, normals_;
  Eigen::VectorXf moved_;
  std::vector<int> changed_;  // vertices that are not at rest, or whose normals are not
  std::vector<int> local_;    // by vertex: its index in the part of a dent; -1
};

}  // namespace palpate::view
