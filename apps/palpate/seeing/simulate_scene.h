// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/virtual_sensor.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The scene in front of the virtual sensor.
struct SceneCall {
  std::vector<fs::path> meshes;  ///< one, or a sequence
  geometry::ReadOptions read;
  std::vector<double> turn;         ///< [degrees] about the camera's x, y and z; empty for none
  std::optional<double> wall;       ///< [mm]
  std::vector<double> reflectance;  ///< one number, or red, green, blue
  double specular = 0, shininess = 50;
  fs::path texture;
  double shutter = 0;  ///< share of the time between two meshes during which the shutter is open
};

/// An image of a pattern, as a projector shows it.
/// \param pattern, rig the files of pattern and projector, for messages.
/// \throws FileError if it cannot be read; InvalidInput if it is not of the projector's size.
[[nodiscard]] cv::Mat read_panel(const fs::path& image, const fs::path& pattern,
                                 const geometry::Camera& projector, const fs::path& rig);

/// The pose of a mesh; all meshes of a sequence get that of the first.
struct Placement {
  Eigen::Isometry3d T_camera_mesh = Eigen::Isometry3d::Identity();
  bool chosen = false;  ///< the distance comes neither from the user nor from the file
};

/// Places the first mesh with the centre of its bounding box at the image centre at the given
/// depth. Without a depth it stays where its file has it or, if it is not completely in view there,
/// is moved to where it fills the image.
[[nodiscard]] Placement place_mesh(const SceneCall& call, const sensing::Rig& rig,
                                   std::optional<double> distance);

/// The mesh with this index, followed by the wall if there is one.
/// \throws InvalidInput if a texture needs texture coordinates that the mesh does not have, or if
/// the meshes blurred by the shutter do not all have the same vertices.
[[nodiscard]] std::vector<sensing::Body> load_bodies(const SceneCall& call, const sensing::Rig& rig,
                                                     const Placement& placement,
                                                     std::size_t number);

}  // namespace palpate::apps
