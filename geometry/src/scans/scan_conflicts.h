// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/merge_scans.h"
#include "scans/distance_volume.h"

namespace palpate::geometry {

/// Finds scans that see a surface where another one saw through: of a moving object, or at a wrong
/// pose.
class ConflictSearch {
 public:
  /// \param scans with the same scans in the frame of the object, `meshes`.
  /// \param tolerance [mm] surfaces that are no farther apart agree.
  ConflictSearch(std::span<const Scan> scans, const std::vector<TriangleMesh>& meshes,
                 const Grid& grid, double tolerance);

  /// Finds the places of other scans that the surface of scan `other` hides.
  /// \param surface its distances, up to the tolerance.
  void add(int other, const DistanceVolume& surface);

  /// The pairs in conflict so far, the worst first.
  [[nodiscard]] std::vector<ScanConflict> found() const;

 private:
  /// A place on a scan.
  struct Place {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();         ///< [mm]
    Eigen::Vector3d to_viewer = Eigen::Vector3d::Zero();  ///< unit length, towards the viewpoint
    double free = 0;  ///< [mm] along that way there is no other surface
  };

  std::vector<std::vector<Place>> places_;  ///< of each scan
  Grid grid_;
  double tolerance_;  ///< [mm]
  std::vector<ScanConflict> found_;
};

}  // namespace palpate::geometry
