// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_doubts.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Lists images: a folder in `paths` is replaced by all images in it, sorted by name.
/// \throws FileError if a path does not exist, or if there is no image at all.
[[nodiscard]] std::vector<fs::path> list_frames(const std::vector<fs::path>& paths);

/// \throws InvalidInput if `path` has the name of the deviations or reasons that `decode` writes
/// beside a range map.
void check_is_depths(const fs::path& path);

/// The deviations that `decode --sigma` writes beside a range map: those of the noise alone
/// (NAME_noise.tiff), or of all (NAME_sigma.tiff) if the former is missing. The file may be
/// missing.
[[nodiscard]] fs::path noise_beside(const fs::path& range_map);

/// Reads a rig, and warns of unlikely values in it.
/// \throws FileError as `sensing::read_rig` does.
/// \throws InvalidInput if such a rig is impossible.
[[nodiscard]] sensing::Rig load_rig(const fs::path& path);

/// Warns of unlikely values, once in a run of the program for each subject.
/// \param source origin of the values, for messages.
/// \throws InvalidInput if a value is impossible.
void tell_doubts(const std::string& source, const std::vector<sensing::Doubt>& doubts);

/// Returns true if `path` is a folder.
/// \throws FileError if it does not exist or is not accessible.
[[nodiscard]] bool is_folder(const fs::path& path);

/// Returns true if `path` exists; false if it is not accessible.
[[nodiscard]] bool is_there(const fs::path& path);

/// The meshes of a folder by name, without those in folders of it: files with the usual endings.
[[nodiscard]] std::vector<fs::path> list_meshes(const fs::path& folder);

/// Descriptions of the reasons in pictures, by their code.
[[nodiscard]] std::vector<std::string> reason_words();

/// Returns true if a file has this type according to its extension.
[[nodiscard]] bool is_range_map(const fs::path& path);
[[nodiscard]] bool is_image(const fs::path& path);
/// Returns true if a PNG has the pixels of a depth image; false if it cannot be read.
[[nodiscard]] bool is_depth_image(const fs::path& path);
/// Type of a file by its name: predicted deviations (in all, or of the noise alone) and reasons, as
/// written by `decode`.
[[nodiscard]] bool is_sigma(const fs::path& path);
[[nodiscard]] bool is_noise(const fs::path& path);
[[nodiscard]] bool is_reasons(const fs::path& path);

/// Reads a rigid motion: a text file with the 3 x 4 or 4 x 4 numbers of its matrix, row by row,
/// separated by spaces, commas or line ends; translation in mm.
/// \throws FileError naming the fault: the file is missing, has another number of numbers or one
/// that is not finite, has a last row other than 0 0 0 1, or the matrix is not a rotation
/// (orthogonal to 1e-6, right-handed).
[[nodiscard]] Eigen::Isometry3d read_pose(const fs::path& path);

}  // namespace palpate::apps
