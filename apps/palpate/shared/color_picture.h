// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/geometry/mesh_io.h"
#include "shared/inputs.h"

namespace palpate::apps {

/// Colours of the vertices of a range map's mesh, from the picture that `decode --surface-color`
/// has written beside the range map.
/// \param vertices 3 x V [mm], camera frame
/// \throws FileError if the picture is missing, or has not the size of the range map.
[[nodiscard]] geometry::Attributes colors_beside(const std::filesystem::path& range_map,
                                                 const Eigen::Matrix3Xd& vertices,
                                                 const MapCamera& camera);

}  // namespace palpate::apps
