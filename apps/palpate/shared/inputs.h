// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/range_map_selection.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/depth_recording.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_doubts.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Lists images: a folder in `paths` is replaced by all images in it, sorted by name.
/// \throws FileError if a path does not exist, or if there is no image at all.
[[nodiscard]] std::vector<fs::path> list_frames(const std::vector<fs::path>& paths);

/// The rig of a range map: `rig` or, if that is empty, the rig.yaml beside the range map.
/// \throws FileError if there is none beside it.
[[nodiscard]] fs::path rig_of(const fs::path& range_map, const fs::path& rig);

/// What range maps need besides themselves, read once for all of them.
struct MapFiles {
  sensing::CameraFiles cameras;
  sensing::DepthRecordings recordings;
};

/// Camera of range maps (TIFF), and camera and unit of depth images (16-bit PNG) of other cameras.
struct MapCamera {
  fs::path rig = {};  ///< rig or camera file; if empty, the rig.yaml beside the map
  /// [mm] Length of one unit of a depth image; if missing, as the camera file or the layout of the
  /// recording tells.
  std::optional<double> scale = {};
  std::vector<double> intrinsics = {};  ///< of a depth image: fx, fy, cx, cy [px]; empty: see `rig`
  geometry::RangeMapSelectionOptions selection = {};  ///< of the depths to keep
  /// Image whose non-zero pixels are kept, or a folder with NAME.png for each range map NAME; may
  /// be empty.
  fs::path mask = {};
  std::shared_ptr<MapFiles> files = std::make_shared<MapFiles>();  ///< that copies share
};

/// Adds the options `--rig` (or `--camera`), `--scale` and `--intrinsics`.
void add_camera_options(CLI::App& command, MapCamera& camera);

/// Adds the options that select depths: `--near`, `--far`, `--crop`, `--mask`, `--remove-plane`.
void add_selection_options(CLI::App& command, MapCamera& camera);

/// Checks that the options suit each other and a range map or a depth image, without reading it.
/// \throws InvalidInput.
/// \throws FileError if the mask is missing.
void check_camera_options(const fs::path& path, const MapCamera& camera);

/// The mask of a range map. \param mask see `MapCamera`; not empty.
/// \throws FileError if `mask` is missing.
[[nodiscard]] fs::path mask_file(const fs::path& range_map, const fs::path& mask);

/// [mm] The length of one unit of a depth image, if it is known. Tells once that a recording
/// implies it.
[[nodiscard]] std::optional<double> unit_of(const fs::path& depth_image, const MapCamera& camera);

/// Reads a range map or a depth image, and tells what is unlikely about its camera and depths.
/// Selects depths as the options say, and tells which of them leave out nothing.
/// \throws FileError if it, its rig or its mask is missing or damaged.
/// \throws InvalidInput if the options do not suit it, if its size is not the camera's, if there
/// cannot be such a camera or such depths, or if the options leave out all of them.
[[nodiscard]] geometry::RangeMap load_range_map(const fs::path& path, const MapCamera& camera);

/// The deviations that `decode --sigma` writes beside a range map: those of the noise alone
/// (NAME_noise.tiff), or of all (NAME_sigma.tiff) if the former is missing. The file may be
/// missing.
[[nodiscard]] fs::path noise_beside(const fs::path& range_map);

/// Reads a rig, and tells what is unlikely about it.
/// \throws FileError as `sensing::read_rig` does.
/// \throws InvalidInput if there cannot be such a rig.
[[nodiscard]] sensing::Rig load_rig(const fs::path& path);

/// Warns of what is unlikely, once in a run of the program for each subject.
/// \param source what the figures belong to, for messages.
/// \throws InvalidInput if something is impossible.
void tell_doubts(const std::string& source, const std::vector<sensing::Doubt>& doubts);

/// Whether `path` is a folder.
/// \throws FileError if it does not exist or is not accessible.
[[nodiscard]] bool is_folder(const fs::path& path);

/// Whether `path` exists; false if it is not accessible.
[[nodiscard]] bool is_there(const fs::path& path);

/// The meshes of a folder by name, without those in folders of it: files with the usual endings.
[[nodiscard]] std::vector<fs::path> list_meshes(const fs::path& folder);

/// Lists range maps or depth images: a folder in `paths` is replaced by those in it by name,
/// without the other files that `decode` writes, or by the depth images that its depth.txt lists.
/// \throws FileError if a folder has none, or a PNG has other pixels than those of a depth image.
/// \throws InvalidInput if there are both range maps and depth images, or files of another type.
[[nodiscard]] std::vector<fs::path> list_range_maps(const std::vector<fs::path>& paths,
                                                    const MapCamera& camera);

/// Descriptions of the reasons in pictures, by their code.
[[nodiscard]] std::vector<std::string> reason_words();

/// Type of a file by its extension.
[[nodiscard]] bool is_range_map(const fs::path& path);
[[nodiscard]] bool is_image(const fs::path& path);
/// Type of a file by its name: predicted deviations (in all, or of the noise alone) and reasons, as
/// written by `decode`.
[[nodiscard]] bool is_sigma(const fs::path& path);
[[nodiscard]] bool is_noise(const fs::path& path);
[[nodiscard]] bool is_reasons(const fs::path& path);

}  // namespace palpate::apps
