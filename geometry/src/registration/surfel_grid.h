// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A flat piece of a surface: the mean of the surface in one cell of a grid.
struct Surfel {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit length
};

/// Approximate nearest surface position and normal in a few nanoseconds: a grid of cubes around the
/// mesh, each of which stores the surfel nearest to its centre (exact distance transform,
/// Felzenszwalb and Huttenlocher 2012). Accurate to about one cell; for searches that end with a
/// `SurfaceQuery`.
class SurfelGrid {
 public:
  /// Precondition: a valid mesh with an area.
  explicit SurfelGrid(const TriangleMesh& mesh);

  /// A point outside the grid gets the surfel of the nearest cell.
  [[nodiscard]] const Surfel& nearest(const Eigen::Vector3d& point) const {
    const Eigen::Array3i cell =
        ((point - lower_).array() / cell_size_).max(0).min((cells_ - 1).cast<double>()).cast<int>();
    return surfels_[static_cast<size_t>(
        nearest_[static_cast<size_t>((cell[2] * cells_[1] + cell[1]) * cells_[0] + cell[0])])];
  }

  [[nodiscard]] double cell_size() const { return cell_size_; }
  /// Mean position of the surface.
  [[nodiscard]] Eigen::Vector3d centroid() const { return centroid_; }

 private:
  void collect_surfels(const TriangleMesh& mesh);
  void spread_along(int axis, std::vector<int>& squared_distance);

  double cell_size_;
  Eigen::Vector3d lower_;  ///< corner of the grid
  Eigen::Array3i cells_;   ///< along each axis
  Eigen::Vector3d centroid_ = Eigen::Vector3d::Zero();
  std::vector<Surfel> surfels_;
  std::vector<int> nearest_;  ///< surfel of each cell
};

}  // namespace palpate::geometry
