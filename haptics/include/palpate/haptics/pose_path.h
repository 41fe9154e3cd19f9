// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// The pose of an object at a time.
struct PosePoint {
  double time = 0;                                                   ///< [s]
  Eigen::Isometry3d T_world_object = Eigen::Isometry3d::Identity();  ///< translation [mm]
};

/// The path of a rigid object through poses at their times: between two it moves straight and turns
/// about one axis, both at constant speed. Before the first and after the last it stands still.
class PosePath {
 public:
  /// \throws InvalidInput without points, with a pose that is not rigid (to 1e-6), or with times
  /// that are not finite or do not increase.
  explicit PosePath(std::vector<PosePoint> points);

  /// T_world_object at `time` [s]. Real-time safe.
  [[nodiscard]] Eigen::Isometry3d pose(double time) const noexcept;
  /// [s] of the first point and of the last.
  [[nodiscard]] double begin() const noexcept { return points_.front().time; }
  [[nodiscard]] double end() const noexcept { return points_.back().time; }

 private:
  std::vector<PosePoint> points_;
};

/// Reads a CSV file (see probing/csv.h) with the columns `t,x,y,z,qw,qx,qy,qz` [s, mm]: translation
/// and unit quaternion of T_world_object, in the order of time.
/// \throws FileError naming the line and what is wrong with it, or if there is no row.
[[nodiscard]] PosePath read_pose_path(const std::filesystem::path& path);

}  // namespace palpate::haptics
