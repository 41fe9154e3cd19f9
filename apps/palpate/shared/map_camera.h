// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/geometry/range_map_selection.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/depth_recording.h"
#include "shared/inputs.h"

namespace palpate::apps {

/// The rig of a range map: `rig` or, if that is empty, the rig.yaml beside the range map.
/// \throws FileError if there is none beside it.
[[nodiscard]] fs::path rig_of(const fs::path& range_map, const fs::path& rig);

/// Files that range maps need besides themselves, read once for all of them.
struct MapFiles {
  sensing::CameraFiles cameras;
  sensing::DepthRecordings recordings;
};

/// Camera of range maps (TIFF), and camera and unit of depth images (16-bit PNG) of other cameras.
struct MapCamera {
  fs::path rig = {};  ///< rig or camera file; if empty, the rig.yaml beside the map
  /// [mm] Length of one unit of a depth image; if missing, that of the camera file or of the layout
  /// of the recording.
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

/// \throws InvalidInput if an option is only for depth images, and `path` is not a depth image.
void check_is_no_depth_call(const fs::path& path, const MapCamera& camera);

/// \throws InvalidInput if depths are to be selected, which a mesh does not have.
void check_selects_nothing(const fs::path& mesh, const MapCamera& camera);

/// \throws InvalidInput if the option `--unit` is given, which range maps and depth images do not
/// have. \param files for which that option is, for the message.
void check_has_no_unit(const fs::path& map, const geometry::ReadOptions& options,
                       const char* files = "mesh files");

/// The mask of a range map. \param mask see `MapCamera`; not empty.
/// \throws FileError if `mask` is missing.
[[nodiscard]] fs::path mask_file(const fs::path& range_map, const fs::path& mask);

/// [mm] Returns the length of one unit of a depth image, if it is known. Reports once if a
/// recording implies it.
[[nodiscard]] std::optional<double> unit_of(const fs::path& depth_image, const MapCamera& camera);

/// Reads a range map or a depth image, and warns of unlikely values of its camera and depths.
/// Selects depths by the options, and reports which of them leave out nothing.
/// \throws FileError if it, its rig or its mask is missing or damaged.
/// \throws InvalidInput if the options do not suit it, if its size is not the camera's, if such a
/// camera or such depths are impossible, or if the options leave out all of them.
[[nodiscard]] geometry::RangeMap load_range_map(const fs::path& path, const MapCamera& camera);

/// Lists range maps or depth images: a folder in `paths` is replaced by those in it by name,
/// without the other files that `decode` writes, or by the depth images that its depth.txt lists.
/// \throws FileError if a folder has none, or a PNG has other pixels than those of a depth image.
/// \throws InvalidInput if there are both range maps and depth images, or files of another type.
[[nodiscard]] std::vector<fs::path> list_range_maps(const std::vector<fs::path>& paths,
                                                    const MapCamera& camera);

/// Reads an image whose non-zero pixels form a mask.
/// \throws FileError if it cannot be read.
/// \throws InvalidInput unless it has one channel and the size of `map`.
[[nodiscard]] geometry::PixelMask read_mask(const fs::path& path, const geometry::ImageF& map);

}  // namespace palpate::apps
