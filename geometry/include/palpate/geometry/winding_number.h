// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Inside and outside of a surface, also of an open one such as a scan, by the generalised winding
/// number (Jacobson, Kavan and Sorkine-Hornung 2013): the sum of the solid angles of the triangles
/// seen from a point, over 4 pi, positive for a triangle seen from its back. It is 1 inside and 0
/// outside of a closed surface; across a hole it passes smoothly from one to the other, 1/2 about
/// where the surface would close the hole. Pieces that overlap or repeat add up.
///
/// A tree of clusters of triangles replaces distant triangles by moments up to the second (Barill
/// et al. 2018). Unlike there, each cluster has a proven bound of the error that this makes, from
/// the Taylor remainder of 1/distance, and the cluster with the largest is opened until all bounds
/// together are within the tolerance. Queries are const and thread-safe.
class WindingNumber {
 public:
  /// Copies the mesh into a tree. \throws InvalidInput if the mesh is not valid (see `check_mesh`).
  explicit WindingNumber(const TriangleMesh& mesh);
  ~WindingNumber();
  WindingNumber(WindingNumber&&) noexcept;
  WindingNumber& operator=(WindingNumber&&) noexcept;

  /// The winding number of a point [mm] within `tolerance` (plus rounding, some 1e-12); 0 is the
  /// exact sum over all triangles. On the surface it is that of either side. NaN if the point is
  /// not finite.
  /// \throws InvalidInput unless tolerance >= 0.
  [[nodiscard]] double at(const Eigen::Vector3d& point, double tolerance = 0.01) const;

  /// Returns true if the winding number exceeds 1/2. Clusters are opened until that is certain, so
  /// a point near the surface costs more than one far from it. False if the point is not finite.
  [[nodiscard]] bool contains(const Eigen::Vector3d& point) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Computes `at` of each column, using all threads. \param points [mm] 3 x N.
/// \throws InvalidInput unless tolerance >= 0.
[[nodiscard]] Eigen::VectorXd winding_numbers(const WindingNumber& winding,
                                              const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                              double tolerance = 0.01);

/// Computes `contains` of each column, using all threads. \param points [mm] 3 x N.
[[nodiscard]] Eigen::VectorX<bool> contained(const WindingNumber& winding,
                                             const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace palpate::geometry
