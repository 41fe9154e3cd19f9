// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "palpate/geometry/mesh_io.h"
#include "shared/map_camera.h"

namespace palpate::apps {

/// The options of `palpate export --html`; other formats take some of them.
struct PageCall {
  fs::path input, output;
  std::string title;
  std::optional<double> unknown_friction;  ///< of models
  MapCamera camera;                        ///< of range maps and depth images
  std::optional<int> every;                ///< of sequences: only every Nth frame
  geometry::ReadOptions meshes;
};

/// The kind of content of a file or folder, of those that a page can show.
enum class PageContent { model, range_maps, meshes };

/// Returns the kind of content. A file that is not an image counts as a mesh: its reader reports
/// errors. \throws FileError if there is no such file, or the folder has none of these.
[[nodiscard]] PageContent content_of(const fs::path& path);

/// Checks the options of a call without a page.
/// \param is_animation true if the call writes an animation of a folder.
/// \throws InvalidInput naming an option that is only for pages, or not for this content.
void check_surface_options(const PageCall& call, PageContent content, bool is_animation);

/// model.html, range.html or mesh.html.
[[nodiscard]] fs::path usual_name(PageContent content);

/// Writes the page of a model, of range maps or of meshes.
/// \returns what was written, in words; empty for a model.
/// \throws InvalidInput also if an option is not for this content.
std::string export_page(const PageCall& call, PageContent content);

}  // namespace palpate::apps
