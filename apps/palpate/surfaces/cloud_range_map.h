// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "palpate/geometry/camera.h"
#include "palpate/geometry/mesh_io.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Writes an organised cloud as a range map NAME.tiff, its colours, if it has some, as
/// NAME_color.png, and its camera as the rig.yaml of the folder, unless it is there.
/// \param camera that of the cloud. Without it, that of the rig.yaml in the folder or, if there is
/// none, the one without lens distortion that fits the points.
/// \returns what became of the camera, in words.
/// \throws InvalidInput if the cloud is not organised, no camera sees each point at its pixel, or
/// the rig.yaml in the folder is that of another camera. Nothing is written then.
/// \throws OutputError.
[[nodiscard]] std::string write_as_range_map(const fs::path& path,
                                             const geometry::PointCloud& cloud,
                                             const std::optional<geometry::Camera>& camera);

}  // namespace palpate::apps
