// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/arm_prober.h"
#include "palpate/probing/arm_reach.h"

namespace palpate::probing {

/// The pose of an arm before an object, and its options.
struct ArmSetup {
  ArmProberOptions prober;
  LinkClearance links;
  bool knows_pose = false;                    ///< `prober.T_world_base` was given
  std::map<std::string, std::string> driver;  ///< options of a driver
};

/// Reads a setup from a JSON object, such as
///
///     {"pose": [[1, 0, 0, 0], [0, 0, 1, -195], [0, -1, 0, 485]], "structure": 3.5,
///      "calibration": {"angles": 9}, "driver": {"port": "/dev/ttyUSB0"}}
///
/// The members are the fields of ArmProberOptions, LinkClearance and their structs, with their
/// defaults; docs/probing.md lists them.
/// \param source names the text in messages.
/// \throws FileError naming the member, what is wrong with it, and what would be right.
[[nodiscard]] ArmSetup parse_arm_setup(const std::string& text, const std::string& source);

/// The text of a setup with another pose; all other members stay as they are.
/// \throws FileError if `text` is no setup.
[[nodiscard]] std::string with_pose(const std::string& text, const std::string& source,
                                    const Eigen::Isometry3d& T_world_base);

/// The pose of the base from which an arm with these links reaches most of a surface from outside:
/// upright over its mean normal, the surface's longer side across the arm, in the middle of its
/// range and below the sweeps of `sweeps_above_surface`.
[[nodiscard]] Eigen::Isometry3d mount_over(const geometry::TriangleMesh& surface,
                                           const ArmGeometry& geometry);
/// A calibration whose poses stay 20 mm above a surface below `mount_over`.
[[nodiscard]] GravityCalibration sweeps_above_surface();

}  // namespace palpate::probing
