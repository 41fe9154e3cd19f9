// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::apps {

/// Lists images: a folder in `paths` is replaced by all images in it, sorted by name.
/// \throws FileError if a path does not exist, or if there is no image at all.
[[nodiscard]] std::vector<std::filesystem::path> list_frames(
    const std::vector<std::filesystem::path>& paths);

/// The rig of a range map: `rig` or, if that is empty, the rig.yaml beside the range map.
/// \throws FileError if there is none beside it.
[[nodiscard]] std::filesystem::path rig_of(const std::filesystem::path& range_map,
                                           const std::filesystem::path& rig);

/// Reads a range map (TIFF) with the camera of `rig` or, if that is empty, of the rig.yaml beside
/// it.
/// \throws FileError if either is missing or damaged.
/// \throws InvalidInput if their sizes differ.
[[nodiscard]] geometry::RangeMap load_range_map(const std::filesystem::path& path,
                                                const std::filesystem::path& rig);

/// Whether `path` is a folder.
/// \throws FileError if it does not exist or is not accessible.
[[nodiscard]] bool is_folder(const std::filesystem::path& path);

/// Whether `path` exists; false if it is not accessible.
[[nodiscard]] bool is_there(const std::filesystem::path& path);

/// Checks, before anything is computed, that each output can be written and overwrites no input or
/// other output. Empty paths stand for options that were not given.
/// \throws InvalidInput if one of `outputs` equals, or lies in, one of `inputs` or another of
/// `outputs`.
/// \throws OutputError if the folder of an output is a file or may not be written to.
void check_outputs(const std::vector<std::filesystem::path>& inputs,
                   const std::vector<std::filesystem::path>& outputs);

/// The same for a folder that is replaced completely.
/// \throws InvalidInput also if one of `inputs` lies in `folder`.
void check_output_folder(const std::vector<std::filesystem::path>& inputs,
                         const std::filesystem::path& folder);

/// Lists the entries of `folder` that an earlier run of the same command wrote, and which may be
/// replaced. `own` matches the paths of the files that the command writes, relative to the folder
/// and with slashes; `mark` is a file that it always writes.
/// \throws InvalidInput if `folder` is a file, holds any other file, or holds files but not `mark`.
[[nodiscard]] std::vector<std::filesystem::path> own_entries(const std::filesystem::path& folder,
                                                             const std::string& mark,
                                                             const std::regex& own);

/// Lists the range maps in a folder by name, without the other files that `decode` writes.
/// \throws FileError if there is none.
[[nodiscard]] std::vector<std::filesystem::path> list_range_maps(
    const std::filesystem::path& folder);

/// Descriptions of the reasons in pictures, by their code.
[[nodiscard]] std::vector<std::string> reason_words();

/// Type of a file by its extension.
[[nodiscard]] bool is_range_map(const std::filesystem::path& path);
[[nodiscard]] bool is_image(const std::filesystem::path& path);
/// Type of a file by its name: predicted deviations and reasons, as written by `decode`.
[[nodiscard]] bool is_sigma(const std::filesystem::path& path);
[[nodiscard]] bool is_reasons(const std::filesystem::path& path);

}  // namespace palpate::apps
