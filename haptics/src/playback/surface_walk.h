// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::haptics {

/// A place of a surface by its position in a triangle.
struct SurfacePlace {
  int triangle = -1;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
};

/// Triangles that a place touches: its own first, then those across the edges and around the vertex
/// that it lies on.
struct TouchedTriangles {
  static constexpr int kMaxCount = 24;  ///< more are left out
  int count = 0;
  std::array<int, kMaxCount> triangles{};
  bool on_border = false;  ///< the place lies on an edge of the border
};

/// The end of a walk.
struct Walk {
  SurfacePlace at;
  double length = 0;     ///< [mm] really walked, at most what was asked for
  int border_edge = -1;  ///< corner at which the edge of the border begins that ended it; -1: none
};

/// A surface prepared for walks from triangle to triangle. An edge with other than two triangles,
/// or with two of opposite orientation, counts as border. Thread-safe; real-time safe after
/// construction.
class SurfaceWalk {
 public:
  /// Longest walk, in triangles; it ends there.
  static constexpr int kMaxTriangles = 1000;

  /// Precondition: the mesh is valid.
  explicit SurfaceWalk(const geometry::TriangleMesh& surface);

  /// [mm] the diagonal of the box around the triangles.
  [[nodiscard]] double size() const noexcept { return size_; }
  /// Outward unit normal; NaN for a triangle without area.
  [[nodiscard]] const Eigen::Vector3d& normal(int triangle) const noexcept {
    return triangles_[static_cast<std::size_t>(triangle)].normal;
  }
  [[nodiscard]] const Eigen::Vector3d& corner(int triangle, int corner) const noexcept;
  /// The triangle across the edge from `corner` to the next one; -1 at the border.
  [[nodiscard]] int neighbour(int triangle, int corner) const noexcept {
    return triangles_[static_cast<std::size_t>(triangle)]
        .neighbours[static_cast<std::size_t>(corner)];
  }
  /// Barycentric coordinates of a place, not below 0.
  [[nodiscard]] geometry::SurfacePoint point(const SurfacePlace& place) const noexcept;

  /// Walks along the section of the surface with the plane through `from` with this normal (any
  /// length), beginning in `direction`.
  /// \param length [mm] along the section.
  [[nodiscard]] Walk walk(const SurfacePlace& from, const Eigen::Vector3d& plane_normal,
                          const Eigen::Vector3d& direction, double length) const noexcept;

  /// \param tolerance [mm] from a place to an edge that it lies on.
  [[nodiscard]] TouchedTriangles touched(const SurfacePlace& place,
                                         double tolerance) const noexcept;

  /// [rad] of a triangle about a place that it touches: 2 pi inside it, pi on an edge, the angle of
  /// a corner. \param tolerance [mm] as for `touched`.
  [[nodiscard]] double angle(int triangle, const Eigen::Vector3d& place,
                             double tolerance) const noexcept;

 private:
  struct alignas(64) Triangle {
    std::array<int, 3> corners;
    std::array<int, 3> neighbours;
    Eigen::Vector3d normal;
  };
  double size_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Triangle> triangles_;

  void connect();
  // Returns true if a place is this near [mm] to the edge that begins at a corner.
  [[nodiscard]] bool is_on_edge(int triangle, int corner, const Eigen::Vector3d& place,
                                double tolerance) const noexcept;
};

}  // namespace palpate::haptics
