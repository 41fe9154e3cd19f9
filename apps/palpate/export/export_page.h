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

/// What a file or folder holds that a page can show.
enum class PageContent { model, range_maps, meshes };

/// A file that is no image counts as a mesh: its reader says what it is not.
/// \throws FileError if there is no such file, or nothing of these in the folder.
[[nodiscard]] PageContent content_of(const fs::path& path);

/// Checks the options of a call that asks for no page.
/// \param is_animation whether it asks for that of a folder.
/// \throws InvalidInput naming one that is for pages alone, or not for this content.
void check_surface_options(const PageCall& call, PageContent content, bool is_animation);

/// model.html, range.html or mesh.html.
[[nodiscard]] fs::path usual_name(PageContent content);

/// Writes the page of a model, of range maps or of meshes.
/// \returns what was written, in words; empty for a model.
/// \throws InvalidInput also if an option is not for this content.
std::string export_page(const PageCall& call, PageContent content);

}  // namespace palpate::apps
