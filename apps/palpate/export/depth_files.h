// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/map_camera.h"

namespace palpate::apps {

/// [mm] The usual length of one unit of a depth image: 16 bits reach 6.5 m.
inline constexpr double kDepthUnit = 0.1;

/// How the depths of range maps are written for other programs.
struct DepthFormats {
  bool png = false;                 ///< 16 bit, in whole units
  bool npy = false;                 ///< float, exactly
  std::optional<double> unit = {};  ///< [mm] of the PNG; none: `kDepthUnit`
  bool undistort = false;
};

/// Writes the depths of a range map or depth image as NAME.png, NAME.npy or both, and its camera
/// beside them.
/// \param name path without ending. \returns what was written, in words.
/// \throws InvalidInput also if depths do not fit the units, or if the file of another camera is
/// there already.
std::string write_depths(const fs::path& map, const MapCamera& camera, const DepthFormats& formats,
                         const fs::path& name);

/// Writes those of several into a folder, each under its own name, and the camera of all.
/// \throws InvalidInput also if the folder holds other files.
std::string write_depth_folder(const std::vector<fs::path>& maps, const MapCamera& camera,
                               const DepthFormats& formats, const fs::path& folder);

}  // namespace palpate::apps
