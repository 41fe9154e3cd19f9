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
#include "palpate/haptics/reduce_model.h"

namespace palpate::haptics {

/// Where a tool can be, in the frame of the model: where all that is given holds.
struct SceneRegion {
  std::optional<Eigen::AlignedBox3d> box;  ///< [mm]
  /// The side of a plane to which its normal (of any length) points: its offset is <= 0 there.
  std::optional<Eigen::Hyperplane<double, 3>> side;
  /// Positions of the tool [mm]: places within `margin` of those that the tool touches.
  std::vector<Eigen::Vector3d> path;
  double margin = 0;  ///< [mm] > 0, with a path
};

/// Which vertices of a surface lie in a region. A tool of a path touches where it is behind the
/// nearest triangle, or within the margin of it.
/// \throws InvalidInput if no triangle has all its vertices there, saying where the surface, or how
/// far away the path is.
[[nodiscard]] std::vector<bool> reachable_vertices(const geometry::TriangleMesh& surface,
                                                   const SceneRegion& region);

/// What a scene requires of one of its objects.
struct SceneRequirement {
  std::string object;  ///< name
  ReduceOptions options;
  std::optional<SceneRegion> region;
};

/// Reads what a scene file (JSON or YAML, see `read_scene`) requires of an object: its member
/// `require`, which docs/reduce.md describes.
/// \param model folder of the model; it finds the object, unless `object` names it.
/// \throws FileError naming the file, the member, what is wrong with it and what would be right;
/// also if no object, or more than one, has this model, and if the object has no requirement.
[[nodiscard]] SceneRequirement read_scene_requirement(const std::filesystem::path& path,
                                                      const std::filesystem::path& model,
                                                      const std::optional<std::string>& object);

}  // namespace palpate::haptics
