// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "export/export_page.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::apps {

struct SurfaceOptions {
  bool color = false;                      ///< of a range map
  std::optional<double> press_depth = {};  ///< [mm] of a model; none: `reference_press_depth`
};

/// A surface to write, or points without one.
struct ExportedSurface {
  geometry::MeshFile file;
  std::optional<geometry::PointCloud> points = {};  ///< instead of `file`
  std::string words = {};                           ///< about the values at its vertices
};

/// Reads the surface of a model, a range map or a mesh, or points.
/// \param with_presses true if a model's surface gets the values of `press_values`.
/// \param output where it will be, for the names of files that it refers to.
[[nodiscard]] ExportedSurface surface_of(const PageCall& call, PageContent content,
                                         const SurfaceOptions& options, bool with_presses,
                                         const fs::path& output);

/// Writes it in the format of the ending, points only as PLY; PLY with the names that viewers show.
/// \returns its words if the format holds the values.
std::string write_surface(const fs::path& path, ExportedSurface surface);

}  // namespace palpate::apps
