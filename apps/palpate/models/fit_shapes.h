// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "palpate/haptics/build_model.h"
#include "palpate/probing/acquisition.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Learns how the surface of a model follows the tool (`haptics::fit_surface_response`), from the
/// meshes of a folder that `palpate track --reference SURFACE` wrote: that of a sample has the name
/// of its range map, and the triangles of the surface. Samples that slipped, and those without a
/// mesh, are left out.
/// \param surface that the model was built with
/// \throws InvalidInput if no sample names a range map or none has a mesh there, FileError naming
/// a mesh that cannot be read or is not of the surface.
[[nodiscard]] haptics::SurfaceResponse fit_shapes(const haptics::BuildResult& built,
                                                  const geometry::TriangleMesh& surface,
                                                  const probing::CheckedAcquisition& acquisition,
                                                  const fs::path& meshes);

/// "From 120 recorded shapes, ... ", or nothing.
[[nodiscard]] std::string shapes_in_words(const std::optional<haptics::SurfaceResponse>& response);

}  // namespace palpate::apps
