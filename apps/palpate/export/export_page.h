// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

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

/// Checks the options of a call.
/// \param is_page true if a page is among what the call writes.
/// \param is_sequence true if the call writes all meshes or range maps of a folder otherwise.
/// \throws InvalidInput naming an option that is for nothing of it, or not for this content.
void check_page_options(const PageCall& call, PageContent content, bool is_page, bool is_sequence);

/// Returns the files of a folder that --every takes, in their order, or the file alone.
/// \throws InvalidInput if --every is given for one file.
[[nodiscard]] std::vector<fs::path> frames_of(const PageCall& call, PageContent content);

/// model, range or mesh.
[[nodiscard]] fs::path usual_name(PageContent content);

/// Writes the page of a model, of range maps or of meshes.
/// \returns what was written, in words; empty for a model.
std::string export_page(const PageCall& call, PageContent content, const fs::path& output);

}  // namespace palpate::apps
