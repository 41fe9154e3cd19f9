// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::apps {

/// What stands before the virtual sensor, and how.
struct SceneCall {
  std::vector<std::filesystem::path> meshes;  ///< one, or a sequence
  geometry::ReadOptions read;
  std::vector<double> turn;         ///< [degrees] about the camera's x, y and z; empty: not
  std::optional<double> wall;       ///< [mm]
  std::vector<double> reflectance;  ///< one number, or red, green, blue
  double specular = 0, shininess = 50;
  std::filesystem::path texture;
  double shutter = 0;  ///< share of the time between two meshes for which the shutter is open
};

/// The pose of a mesh, so that all meshes of a sequence get that of the first.
struct Placement {
  Eigen::Isometry3d T_camera_mesh = Eigen::Isometry3d::Identity();
  bool chosen = false;  ///< the distance is neither the user's nor the file's
};

/// The first mesh of the call stands with the centre of its bounding box in the middle of the
/// image at that depth; without one where its file says, or, if that is not all in view, where it
/// fills the image.
[[nodiscard]] Placement place_mesh(const SceneCall& call, const sensing::Rig& rig,
                                   std::optional<double> distance);

/// The mesh of that number, and after it the wall if there is one.
/// \throws InvalidInput if it has no texture coordinates for a texture, or if not all meshes that
/// the shutter blurs have the same vertices.
[[nodiscard]] std::vector<sensing::Body> load_bodies(const SceneCall& call, const sensing::Rig& rig,
                                                     const Placement& placement,
                                                     std::size_t number);

}  // namespace palpate::apps
