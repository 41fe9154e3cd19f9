// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Writes a page that shows a mesh, or meshes of the same triangles one after the other, as `track`
/// writes them; with the numbers and colours of their vertices.
/// \returns what was written, in words: frames, size, and what rounding has lost.
/// \throws FileError if a file is damaged; InvalidInput if there is no triangle, the meshes have
/// different triangles, or the page would be too long. Nothing is written then.
std::string write_mesh_page(const fs::path& output, const std::vector<fs::path>& meshes,
                            const geometry::ReadOptions& options, const std::string& title);

}  // namespace palpate::apps
