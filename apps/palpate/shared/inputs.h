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

/// The images among `paths`, where a folder stands for all images in it, by name; each folder's in
/// the order of their names.
/// \throws FileError for a path that does not exist, or when there is no image at all.
[[nodiscard]] std::vector<std::filesystem::path> list_frames(
    const std::vector<std::filesystem::path>& paths);

/// A range map (TIFF) with the camera of `rig`, or, when that is empty, of the rig.yaml beside it.
/// \throws FileError if either is missing or broken; InvalidInput if their sizes differ.
[[nodiscard]] geometry::RangeMap load_range_map(const std::filesystem::path& path,
                                                const std::filesystem::path& rig);

/// Whether `path` is a folder.
/// \throws FileError if there is nothing, or it cannot be looked at.
[[nodiscard]] bool is_folder(const std::filesystem::path& path);

/// Whether there is anything at `path`; nothing where it cannot be looked at.
[[nodiscard]] bool is_there(const std::filesystem::path& path);

/// Refuses to write over what is read, or among it. Empty paths stand for options that were not
/// given.
/// \throws InvalidInput if one of `outputs` is, or lies in, one of `inputs` or another of
/// `outputs`.
void check_outputs(const std::vector<std::filesystem::path>& inputs,
                   const std::vector<std::filesystem::path>& outputs);

/// The same for a folder that is replaced as a whole.
/// \throws InvalidInput also if one of `inputs` lies in `folder`.
void check_output_folder(const std::vector<std::filesystem::path>& inputs,
                         const std::filesystem::path& folder);

/// What an earlier call of the same command left in `folder`, and may be replaced: its entries.
/// `own` matches the paths, relative to it and with slashes, of the files that the command writes;
/// `mark` is one that it always does.
/// \throws InvalidInput if `folder` is a file, or holds another file, or files but not `mark`.
[[nodiscard]] std::vector<std::filesystem::path> own_entries(const std::filesystem::path& folder,
                                                             const std::string& mark,
                                                             const std::regex& own);

/// The range maps in a folder, by name; not what else `decode` writes beside them.
/// \throws FileError if there is none.
[[nodiscard]] std::vector<std::filesystem::path> list_range_maps(
    const std::filesystem::path& folder);

/// What a pixel without a depth is called in pictures, by its code.
[[nodiscard]] std::vector<std::string> reason_words();

/// What `path` is, by its ending.
[[nodiscard]] bool is_range_map(const std::filesystem::path& path);
[[nodiscard]] bool is_image(const std::filesystem::path& path);
/// By its name: predicted deviations and reasons, as `decode` writes them.
[[nodiscard]] bool is_sigma(const std::filesystem::path& path);
[[nodiscard]] bool is_reasons(const std::filesystem::path& path);

}  // namespace palpate::apps
