// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/depth_files.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/depth_array.h"
#include "palpate/geometry/range_map_undistortion.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/depth_image.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

constexpr double kMmOfMetre = 1000;

/// The file of the camera: in the format of Open3D, which knows no lens distortion, or in one that
/// does.
constexpr const char* kPinholeFile = "camera_intrinsic.json";
constexpr const char* kLensFile = "camera.yaml";

bool has_distortion(const geometry::Camera& camera) {
  return camera.distortion != geometry::Camera{}.distortion;
}

fs::path with_ending(fs::path name, const char* ending) { return name += ending; }

/// [mm] Length of one unit of what is written, for the file of the camera.
double written_unit(const DepthFormats& formats) {
  return formats.png ? formats.unit.value_or(kDepthUnit) : 1;
}

/// Reads the depths as they are to be written.
geometry::RangeMap load_to_write(const fs::path& path, const MapCamera& camera,
                                 const DepthFormats& formats) {
  geometry::RangeMap map = load_range_map(path, camera);
  if (!formats.undistort) return map;
  if (!has_distortion(map.camera)) {
    throw InvalidInput(path.string() +
                       ": its camera has no lens distortion; leave out --undistort.");
  }
  return geometry::undistorted(map);
}

void write_depths_of(const geometry::RangeMap& map, const DepthFormats& formats,
                     const fs::path& name) {
  if (formats.png)
    sensing::write_depth_image(with_ending(name, ".png"), map.z, written_unit(formats));
  if (formats.npy) geometry::write_depth_array(with_ending(name, ".npy"), map.z);
}

const char* camera_name(const geometry::Camera& camera) {
  return has_distortion(camera) ? kLensFile : kPinholeFile;
}

void write_camera_into(const fs::path& folder, const geometry::Camera& camera,
                       const DepthFormats& formats) {
  const fs::path file = folder / camera_name(camera);
  if (has_distortion(camera))
    sensing::write_camera(file, camera);
  else
    sensing::write_open3d_camera(file, camera, written_unit(formats));
}

/// Returns true if the camera is in its file already: depths of several calls may share a folder.
/// \throws InvalidInput if another camera is.
bool is_camera_there(const fs::path& file, const geometry::Camera& camera,
                     const DepthFormats& formats) {
  if (!is_there(file)) return false;
  constexpr double kRounding = 1e-12;
  const sensing::CameraFile there = sensing::read_camera_file(file);
  const double unit = written_unit(formats);
  const bool is_same = there.camera == camera;
  const bool has_unit =
      !formats.png || std::abs(there.mm_per_unit.value_or(unit) - unit) <= kRounding * unit;
  if (is_same && has_unit) return true;
  throw InvalidInput(file.string() + ": is of " + (is_same ? "other units" : "another camera") +
                     " than these depths; write them into another folder.");
}

std::string depths_in_words(const geometry::Camera& camera, const DepthFormats& formats,
                            const fs::path& folder) {
  std::string words;
  if (formats.png) {
    const double unit = written_unit(formats);
    words = fmt::format(
        "units of {:g} mm, so depths are rounded by at most {:g} mm (Open3D: depth_scale={:g}); ",
        unit, unit / 2, kMmOfMetre / unit);
  }
  words += "camera in " + (folder / camera_name(camera)).string();
  if (has_distortion(camera)) {
    words +=
        ", with the lens distortion that these pixels have; programs that know none, such as "
        "Open3D, need --undistort";
  }
  return words;
}

}  // namespace

std::string write_depths(const fs::path& map, const MapCamera& camera, const DepthFormats& formats,
                         const fs::path& name) {
  const geometry::RangeMap depths = load_to_write(map, camera, formats);
  const fs::path folder = name.parent_path();
  const bool has_camera =
      is_camera_there(folder / camera_name(depths.camera), depths.camera, formats);
  write_depths_of(depths, formats, name);
  if (!has_camera) write_camera_into(folder, depths.camera, formats);
  return depths_in_words(depths.camera, formats, folder);
}

std::string write_depth_folder(const std::vector<fs::path>& maps, const MapCamera& camera,
                               const DepthFormats& formats, const fs::path& folder) {
  std::vector<fs::path> entries{kPinholeFile, kLensFile};
  for (const fs::path& map : maps)
    for (const char* ending : {".png", ".npy"}) entries.push_back(with_ending(map.stem(), ending));
  geometry::Camera common;
  Progress progress("writing depths");
  write_folder(folder, entries, [&](const fs::path& place) {
    std::size_t done = 0;
    for (const fs::path& map : maps) {
      const geometry::RangeMap depths = load_to_write(map, camera, formats);
      write_depths_of(depths, formats, place / map.stem());
      if (done == 0) write_camera_into(place, depths.camera, formats);
      common = depths.camera;
      progress.show(++done, maps.size());
    }
  });
  return counted(maps.size(), "range map") + ", " + depths_in_words(common, formats, folder);
}

}  // namespace palpate::apps
