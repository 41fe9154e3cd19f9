// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "scans/nearest_triangles.h"

namespace palpate::geometry {

/// The distance of a place from a scan.
struct PlaceDistance {
  double distance = 0;   ///< [mm] > 0 outside of the scan
  double weight = 0;     ///< of the scan at the nearest point; 0 where the distance is unknown
  double beyond = 0;     ///< [mm] how far the place is beyond the border
  double precision = 0;  ///< [mm^-2] 1 / sigma^2 of the scan at the nearest point
};

/// Signed distances to an oriented surface with border.
///
/// The side is that of the pseudonormal at the nearest point: the normal of the triangle, the mean
/// of the two normals at an edge, or the mean weighted by the angles at a vertex, which is right
/// everywhere for a surface that does not intersect itself (Baerentzen and Aanaes 2005). Of places
/// whose nearest point is on the border, those beyond it by up to the overhang have the distance to
/// the tangent plane there; for the others the distance is unknown.
///
/// The weight is 1 / sigma^2, and falls within a few edges of the border, so that the surface does
/// not step where a scan begins, and steeply beyond it.
class ScanDistance {
 public:
  /// \param sigma [mm] V, standard deviations of the vertices, > 0; empty if they are equal.
  /// \param overhang [mm] length by which the scan continues beyond its border.
  /// \throws InvalidInput as `opposite_half_edges`.
  ScanDistance(TriangleMesh mesh, const Eigen::VectorXd& sigma, double overhang);

  /// \param place [mm] finite.
  /// \param near the nearest triangle, and its corner if that is the nearest point.
  [[nodiscard]] PlaceDistance at(const Eigen::Vector3d& place, NearTriangle near) const;
  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  /// Opposites of half-edges, see `opposite_half_edges`.
  [[nodiscard]] const Eigen::Matrix3Xi& opposite() const { return opposite_; }

 private:
  /// The outward direction at a point, and true for `border` if the point is on the border.
  struct Side {
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();  ///< any length; zero if it is unknown
    bool border = false;
  };
  [[nodiscard]] Side side_at(int triangle, const Eigen::Vector3d& barycentric) const;

  TriangleMesh mesh_;
  Eigen::Matrix3Xi opposite_;          ///< of half-edges
  Eigen::Matrix3Xd triangle_normals_;  ///< 3 x T, zero without area
  Eigen::Matrix3Xd vertex_normals_;    ///< 3 x V, of any length
  std::vector<bool> at_border_;        ///< of each vertex
  Eigen::VectorXd feather_;            ///< V, factor of the weight, 1 away from the border
  Eigen::VectorXd precision_;          ///< [mm^-2] V
  double overhang_;                    ///< [mm]
};

}  // namespace palpate::geometry
