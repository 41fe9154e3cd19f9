// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/reduce_model.h"

namespace palpate::haptics {

/// The region in which a tool can be, in the frame of the model: all given conditions hold there.
struct SceneRegion {
  std::optional<Eigen::AlignedBox3d> box;  ///< [mm]
  /// The side of a plane to which its normal (of any length) points: its offset is <= 0 there.
  std::optional<Eigen::Hyperplane<double, 3>> side;
  std::optional<Eigen::Vector3d> camera;  ///< [mm] vertices that a camera there sees
  /// Positions of the tool [mm]: places within `margin` of those that the tool touches.
  std::vector<Eigen::Vector3d> path;
  double margin = 0;  ///< [mm] > 0, with a path
};

/// Returns for each vertex of a surface whether it lies in a region. A tool of a path touches where
/// it is behind the nearest triangle, or within the margin of it. A camera sees a vertex if one of
/// its triangles faces it and the surface is not between them.
/// \throws InvalidInput if no triangle has all its vertices there, stating where the surface is, or
/// how far away the path is.
[[nodiscard]] std::vector<bool> reachable_vertices(const geometry::TriangleMesh& surface,
                                                   const SceneRegion& region);

/// The requirements of a scene on one of its objects.
struct SceneRequirement {
  std::string object;           ///< name
  std::filesystem::path model;  ///< folder, made relative to that of the scene file
  ReduceOptions options;
  std::optional<SceneRegion> region;
  std::optional<double> arm_time;     ///< [s] for which an arm may probe it
  std::optional<double> tool_radius;  ///< [mm] of the ball that touches it in the scene
  PlaybackOptions playback;           ///< how the object is played
};

/// The requirements of a scene on all its objects together, and on each with a member `require`.
struct SceneRequirements {
  std::optional<double> arm_time;  ///< [s] for all of them
  std::vector<SceneRequirement> objects;
};

/// Reads the requirements of a scene file (JSON or YAML, see `read_scene`): its member `budget` and
/// the members `require` of its objects, which docs/reduce.md describes.
/// \throws FileError naming the file, the member, what is wrong with it and what would be right;
/// also if no object has a requirement.
[[nodiscard]] SceneRequirements read_scene_requirements(const std::filesystem::path& path);

/// Reads the requirements of a scene file on one of its objects.
/// \param model folder of the model; it finds the object, unless `object` names it. Empty: the
/// object must be named if several have a requirement.
/// \throws FileError as `read_scene_requirements`; also if no object, or more than one, is meant.
[[nodiscard]] SceneRequirement read_scene_requirement(const std::filesystem::path& path,
                                                      const std::filesystem::path& model,
                                                      const std::optional<std::string>& object);

}  // namespace palpate::haptics
