// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// Reads positions of a tip that touches, a CSV file with the columns x, y and z [mm].
/// \return 3 x N
/// \throws FileError naming file, line and column.
[[nodiscard]] Eigen::Matrix3Xd read_touches(const std::filesystem::path& path);

/// A pose of an arm, and the file with what the camera saw then.
struct SeenPose {
  std::string seen;                               ///< as in the table
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  ///< [mm] frame of the base
  std::optional<Eigen::Quaterniond> R_base_tip = {};
};

/// Reads poses of an arm, a CSV file with the columns range_map, x, y and z [mm]; if the tip turns,
/// also qx, qy, qz and qw, the unit quaternion that turns directions of the tip into those of the
/// base.
/// \throws FileError naming file, line and column.
[[nodiscard]] std::vector<SeenPose> read_seen_poses(const std::filesystem::path& path);

}  // namespace palpate::probing
