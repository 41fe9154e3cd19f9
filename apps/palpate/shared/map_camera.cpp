// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/map_camera.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>
#include <opencv2/core.hpp>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"
#include "shared/call_checks.h"
#include "shared/field_options.h"
#include "shared/result_folder.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// \throws FileError if `path` is a PNG but not a depth image. The reader reports a damaged
/// file.
void check_depth_image(const fs::path& path) {
  const std::optional<sensing::PngPixels> pixels = sensing::read_png_pixels(path);
  if (!pixels || sensing::may_be_depths(*pixels)) return;
  throw FileError(path.string() + ": is " + (pixels->channels == 1 ? "a grey" : "a colour") +
                  " image of " + std::to_string(pixels->bits) +
                  " bit; expected depth images (16-bit single-channel PNG) or a folder of "
                  "range maps (tiff), as palpate decode writes them.");
}

InvalidInput both_kinds(const fs::path& range_map, const fs::path& depth_image) {
  return InvalidInput(depth_image.string() + ": is a depth image, but " + range_map.string() +
                      " is a range map (TIFF); a sequence has one kind. Put them into folders of "
                      "their own.");
}

/// Lists the range maps, or the depth images if there are none. Pictures beside range maps are
/// neither.
std::vector<fs::path> range_maps_in(const fs::path& folder, const MapCamera& camera) {
  if (sensing::is_depth_recording(folder)) {
    std::vector<fs::path> depths;
    for (const sensing::RecordedDepth& frame : camera.files->recordings.read(folder)) {
      if (is_there(frame.depth)) check_depth_image(frame.depth);  // its reader reports missing ones
      depths.push_back(frame.depth);
    }
    return depths;
  }
  check_is_of_one_run(folder);
  std::vector<fs::path> maps, images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (is_hidden(path) || is_sigma(path) || is_reasons(path)) continue;
    if (is_range_map(path))
      maps.push_back(path);
    else if (is_image(path))
      images.push_back(path);
  }
  std::ranges::sort(maps, comes_before);
  std::ranges::sort(images, comes_before);
  if (!maps.empty()) {
    const auto depths = std::ranges::find_if(images, is_depth_image);
    if (depths != images.end()) throw both_kinds(maps.front(), *depths);
    return maps;
  }
  if (images.empty()) {
    const bool has_depths = is_there(folder / "depth");
    throw FileError(folder.string() +
                    ": there is no range map in it; expected a folder of range maps (tiff), as "
                    "palpate decode writes them, or of depth images (16-bit PNG)" +
                    (has_depths ? "; pass " + (folder / "depth").string() + "." : "."));
  }
  std::ranges::for_each(images, check_depth_image);
  return images;
}

fs::path rig_beside(const fs::path& range_map) { return range_map.parent_path() / "rig.yaml"; }

geometry::Camera camera_of(const fs::path& depth_image, const MapCamera& camera) {
  if (camera.intrinsics.empty())
    return camera.files->cameras.read(rig_of(depth_image, camera.rig)).camera;
  const cv::Mat image = sensing::read_frame(depth_image);
  return {.width = image.cols,
          .height = image.rows,
          .fx = camera.intrinsics[0],
          .fy = camera.intrinsics[1],
          .cx = camera.intrinsics[2],
          .cy = camera.intrinsics[3]};
}

geometry::RangeMap read_range_map(const fs::path& path, const MapCamera& camera) {
  const fs::path of_map = rig_of(path, camera.rig);
  geometry::RangeMap map{.z = geometry::read_depth_tiff(path),
                         .camera = camera.files->cameras.read(of_map).camera};
  if (map.z.cols() != map.camera.width || map.z.rows() != map.camera.height) {
    throw InvalidInput(path.string() + ": " + std::to_string(map.z.cols()) + " x " +
                       std::to_string(map.z.rows()) + " pixels, but the camera of " +
                       of_map.string() + " has " + std::to_string(map.camera.width) + " x " +
                       std::to_string(map.camera.height) +
                       ". Pass the rig that this range map was made with.");
  }
  return map;
}

/// An option that selects depths.
struct SelectionOption {
  const char* name;
  bool given;
  long left_out;
  std::string words;     ///< the depths that it left out: "are nearer than --near 300"
  std::string why_none;  ///< the reason if it leaves out nothing
};

std::vector<SelectionOption> selection_options(const geometry::RangeMapSelection& selection,
                                               const MapCamera& camera) {
  const geometry::RangeMapSelectionOptions& options = camera.selection;
  return {{"--near", options.near.has_value(), selection.too_near,
           fmt::format("are nearer than --near {:g}", options.near.value_or(0)),
           fmt::format("the nearest depth is {:.4g} mm", selection.nearest)},
          {"--far", options.far.has_value(), selection.too_far,
           fmt::format("are farther than --far {:g}", options.far.value_or(0)),
           fmt::format("the farthest depth is {:.4g} mm", selection.farthest)},
          {"--crop", !options.crop.empty(), selection.outside_crop, "are outside --crop",
           "all points are inside"},
          {"--mask", !camera.mask.empty(), selection.masked, "are outside --mask",
           "all depths are inside"},
          {"--remove-plane", options.remove_plane.has_value(), selection.on_plane,
           "are on the plane of --remove-plane or behind it",
           fmt::format("no plane has {:.0f} % of the points within {:g} mm",
                       100 * geometry::kLeastPlane, options.remove_plane.value_or(0))}};
}

/// "12 are nearer than --near 300, 5 are outside --crop"
std::string left_out_in_words(const geometry::RangeMapSelection& selection,
                              const MapCamera& camera) {
  std::vector<std::string> words;
  for (const SelectionOption& option : selection_options(selection, camera))
    if (option.given) words.push_back(fmt::format("{} {}", option.left_out, option.words));
  if (selection.without_ray > 0) {
    words.push_back(
        fmt::format("{} have no direction because of the lens distortion", selection.without_ray));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Reports the options that left out nothing, each once.
void tell_idle_options(const fs::path& path, const geometry::RangeMapSelection& selection,
                       const MapCamera& camera) {
  std::vector<sensing::Doubt> doubts;
  for (const SelectionOption& option : selection_options(selection, camera)) {
    if (!option.given || option.left_out > 0) continue;
    doubts.push_back(
        {.subject = option.name,
         .message = fmt::format("{} leaves out nothing: {}", option.name, option.why_none)});
  }
  tell_doubts(path.string(), doubts);
}

/// \throws InvalidInput if nothing is left of some depths.
geometry::ImageF selected_depths(const fs::path& path, const geometry::RangeMap& map,
                                 const MapCamera& camera) {
  const geometry::PixelMask mask =
      camera.mask.empty() ? geometry::PixelMask() : read_mask(mask_file(path, camera.mask), map.z);
  geometry::RangeMapSelection selection = geometry::select_depths(map, camera.selection, mask);
  if (selection.known > 0 && selection.kept == 0) {
    throw InvalidInput(
        fmt::format("{}: no depth is left: of {} pixels with a depth ({:.4g} to {:.4g} mm), {}",
                    path.string(), selection.known, selection.nearest, selection.farthest,
                    left_out_in_words(selection, camera)));
  }
  if (selection.known > 0) tell_idle_options(path, selection, camera);
  return std::move(selection.z);
}

}  // namespace

geometry::PixelMask read_mask(const fs::path& path, const geometry::ImageF& map) {
  const cv::Mat image = sensing::read_frame(path);
  if (image.channels() != 1 || image.rows != map.rows() || image.cols != map.cols()) {
    throw InvalidInput(
        fmt::format("{}: has {} x {} px and {}; a mask needs the {} x {} px of the range map and "
                    "one channel, whose non-zero pixels count.",
                    path.string(), image.cols, image.rows, counted(image.channels(), "channel"),
                    map.cols(), map.rows()));
  }
  cv::Mat1b chosen;
  cv::compare(image, 0, chosen, cv::CMP_NE);
  geometry::PixelMask mask(chosen.rows, chosen.cols);
  std::copy(chosen.begin(), chosen.end(), mask.data());
  return mask;
}

std::vector<fs::path> list_range_maps(const std::vector<fs::path>& paths, const MapCamera& camera) {
  std::vector<fs::path> maps;
  for (const fs::path& path : paths) {
    if (is_folder(path)) {
      const std::vector<fs::path> in_folder = range_maps_in(path, camera);
      maps.insert(maps.end(), in_folder.begin(), in_folder.end());
    } else if (!is_image(path)) {
      throw InvalidInput(path.string() +
                         ": is no range map (TIFF) and no depth image (16-bit PNG); a sequence "
                         "consists of these.");
    } else {
      if (!is_range_map(path)) check_depth_image(path);
      maps.push_back(path);
    }
  }
  const auto other = std::ranges::find_if(
      maps, [&](const fs::path& map) { return is_range_map(map) != is_range_map(maps.front()); });
  if (other == maps.end()) return maps;
  throw is_range_map(*other) ? both_kinds(*other, maps.front()) : both_kinds(maps.front(), *other);
}

fs::path rig_of(const fs::path& range_map, const fs::path& rig) {
  if (!rig.empty()) return rig;
  fs::path beside = rig_beside(range_map);
  std::error_code ignored;
  if (!fs::exists(beside, ignored)) {
    throw FileError(
        beside.string() +
        ": missing. A range map needs its camera: put the rig beside it, or pass --rig.");
  }
  return beside;
}

void add_camera_options(CLI::App& command, MapCamera& camera) {
  command.add_option("--rig,--camera", camera.rig,
                     "Rig of the range map, or camera of the depth image: a file of Palpate, ROS "
                     "(camera_info), RealSense or Open3D (default: rig.yaml beside it)");
  add_number(command, "--scale", camera.scale, above(0),
             "Depth image: length of one unit [mm] (default: as recorded by Open3D, and 0.2 "
             "if a depth.txt lists it, the layout of TUM RGB-D)");
  command
      .add_option("--intrinsics", camera.intrinsics,
                  "Depth image: fx,fy,cx,cy of its camera [px], instead of --camera")
      ->expected(4)
      ->delimiter(',');
}

void add_selection_options(CLI::App& command, MapCamera& camera) {
  add_fields(command, fields_of(camera.selection));
  command.add_option(
      "--mask", camera.mask,
      "Leave out depths where this image is 0 (PNG of the size of the range map); or "
      "a folder that has NAME.png for each range map NAME");
}

void check_is_no_depth_call(const fs::path& path, const MapCamera& camera) {
  if (!camera.scale && camera.intrinsics.empty()) return;
  throw InvalidInput(path.string() + ": " + (camera.scale ? "--scale" : "--intrinsics") +
                     " works for depth images (16-bit PNG), which this is not");
}

void check_selects_nothing(const fs::path& mesh, const MapCamera& camera) {
  if (!geometry::selects(camera.selection) && camera.mask.empty()) return;
  throw InvalidInput(mesh.string() +
                     ": --near, --far, --crop, --mask and --remove-plane work for range maps and "
                     "depth images, not for meshes.");
}

void check_has_no_unit(const fs::path& map, const geometry::ReadOptions& options,
                       const char* files) {
  if (!options.unit) return;
  throw InvalidInput(
      map.string() + ": --unit is for " + files + "; " +
      (is_range_map(map) ? "range maps are in mm" : "the unit of a depth image is its --scale"));
}

void check_camera_options(const fs::path& path, const MapCamera& camera) {
  geometry::check_selection(camera.selection);
  if (!camera.mask.empty()) (void)is_folder(camera.mask);  // refuses a missing one
  if (is_range_map(path)) return check_is_no_depth_call(path, camera);
  if (!camera.intrinsics.empty() && !camera.rig.empty()) {
    throw InvalidInput(path.string() +
                       ": --intrinsics and --camera (or --rig) both give its camera; pass one of "
                       "them.");
  }
  if (!unit_of(path, camera)) {
    throw InvalidInput(path.string() +
                       ": a depth image needs --scale, the length of one unit in mm: 1 for most "
                       "RealSense and Kinect cameras.");
  }
  if (camera.intrinsics.empty() && camera.rig.empty() && !is_there(rig_beside(path))) {
    throw InvalidInput(path.string() +
                       ": a depth image needs its camera: --intrinsics fx,fy,cx,cy [px], --camera "
                       "FILE, or a rig.yaml beside it.");
  }
}

fs::path mask_file(const fs::path& range_map, const fs::path& mask) {
  return is_folder(mask) ? mask / (range_map.stem().string() + ".png") : mask;
}

std::optional<double> unit_of(const fs::path& depth_image, const MapCamera& camera) {
  if (camera.scale) return camera.scale;
  const bool has_file = !camera.rig.empty() || is_there(rig_beside(depth_image));
  if (camera.intrinsics.empty() && has_file) {
    const fs::path file = rig_of(depth_image, camera.rig);
    const std::optional<double> unit = camera.files->cameras.read(file).mm_per_unit;
    if (unit) return unit;
  }
  if (!camera.files->recordings.find(depth_image)) return std::nullopt;
  static std::once_flag told;
  std::call_once(told, [&] {
    spdlog::info(
        "{}: is listed by a depth.txt, the layout of TUM RGB-D: one unit is {:g} mm; "
        "--scale sets another.",
        depth_image.string(), sensing::kRecordingUnit);
  });
  return sensing::kRecordingUnit;
}

geometry::RangeMap load_range_map(const fs::path& path, const MapCamera& camera) {
  check_is_depths(path);
  check_camera_options(path, camera);
  geometry::RangeMap map;
  std::optional<double> unit;  // of a depth image
  if (is_range_map(path)) {
    map = read_range_map(path, camera);
  } else {
    unit = unit_of(path, camera);
    map = sensing::read_depth_image(path, *unit, camera_of(path, camera));
  }
  tell_doubts(path.string(), sensing::range_map_doubts(map, unit));
  if (geometry::selects(camera.selection) || !camera.mask.empty())
    map.z = selected_depths(path, map, camera);
  return map;
}

}  // namespace palpate::apps
