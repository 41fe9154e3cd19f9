// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/inputs.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/reason.h"
#include "shared/call_checks.h"
#include "shared/depth_score.h"
#include "shared/field_options.h"
#include "shared/result_folder.h"

namespace palpate::apps {
namespace {

/// \throws FileError if `path` is a PNG but not a depth image. A damaged file is left to its
/// reader.
void check_depth_image(const fs::path& path) {
  const std::optional<sensing::PngPixels> pixels = sensing::read_png_pixels(path);
  if (!pixels || sensing::may_be_depths(*pixels)) return;
  throw FileError(path.string() + ": is " + (pixels->channels == 1 ? "a grey" : "a colour") +
                  " image of " + std::to_string(pixels->bits) +
                  " bit; expected depth images (16-bit single-channel PNG) or a folder of "
                  "range maps (tiff), as palpate decode writes them.");
}

bool is_depth_image(const fs::path& path) {
  const std::optional<sensing::PngPixels> pixels = sensing::read_png_pixels(path);
  return pixels && sensing::may_be_depths(*pixels);
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
      if (is_there(frame.depth)) check_depth_image(frame.depth);  // its reader tells a missing one
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

/// The mask of a range map; empty if there is none.
geometry::PixelMask mask_of(const fs::path& range_map, const geometry::RangeMap& map,
                            const fs::path& mask) {
  if (mask.empty()) return {};
  return read_mask(mask_file(range_map, mask), map.z);
}

/// What each option that is given has left out, in words: "12 nearer than --near 300".
std::string left_out_in_words(const geometry::RangeMapSelection& selection,
                              const MapCamera& camera) {
  const geometry::RangeMapSelectionOptions& options = camera.selection;
  std::vector<std::string> words;
  if (options.near)
    words.push_back(
        fmt::format("{} are nearer than --near {:g}", selection.too_near, *options.near));
  if (options.far)
    words.push_back(fmt::format("{} are farther than --far {:g}", selection.too_far, *options.far));
  if (!options.crop.empty())
    words.push_back(fmt::format("{} are outside --crop", selection.outside_crop));
  if (!camera.mask.empty()) words.push_back(fmt::format("{} are outside --mask", selection.masked));
  if (options.remove_plane)
    words.push_back(
        fmt::format("{} are on the plane of --remove-plane or behind it", selection.on_plane));
  if (selection.without_ray > 0) {
    words.push_back(
        fmt::format("{} have no direction because of the lens distortion", selection.without_ray));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Tells which options have left out nothing, each once.
void tell_idle_options(const fs::path& path, const geometry::RangeMapSelection& selection,
                       const MapCamera& camera) {
  const geometry::RangeMapSelectionOptions& options = camera.selection;
  std::vector<sensing::Doubt> doubts;
  const auto tell = [&](bool given, long left_out, const char* option, const std::string& why) {
    if (given && left_out == 0)
      doubts.push_back(
          {.subject = option, .message = fmt::format("{} leaves out nothing: {}", option, why)});
  };
  tell(options.near.has_value(), selection.too_near, "--near",
       fmt::format("the nearest depth is {:.4g} mm", selection.nearest));
  tell(options.far.has_value(), selection.too_far, "--far",
       fmt::format("the farthest depth is {:.4g} mm", selection.farthest));
  tell(!options.crop.empty(), selection.outside_crop, "--crop", "all points are inside");
  tell(!camera.mask.empty(), selection.masked, "--mask", "all depths are inside");
  tell(options.remove_plane.has_value(), selection.on_plane, "--remove-plane",
       fmt::format("no plane has {:.0f} % of the points within {:g} mm",
                   100 * geometry::kLeastPlane, options.remove_plane.value_or(0)));
  tell_doubts(path.string(), doubts);
}

/// \throws InvalidInput if nothing is left of some depths.
geometry::ImageF selected_depths(const fs::path& path, const geometry::RangeMap& map,
                                 const MapCamera& camera) {
  geometry::RangeMapSelection selection =
      geometry::select_depths(map, camera.selection, mask_of(path, map, camera.mask));
  if (selection.known > 0 && selection.kept == 0) {
    throw InvalidInput(
        fmt::format("{}: no depth is left: of {} pixels with a depth ({:.4g} to {:.4g} mm), {}",
                    path.string(), selection.known, selection.nearest, selection.farthest,
                    left_out_in_words(selection, camera)));
  }
  if (selection.known > 0) tell_idle_options(path, selection, camera);
  return std::move(selection.z);
}

bool may_be_mesh(const fs::path& path) {
  constexpr std::array kEndings{".ply", ".obj", ".off", ".stl", ".gltf", ".glb",
                                ".3ds", ".dae", ".fbx", ".x3d", ".3mf"};
  return std::ranges::find(kEndings, lower_extension(path)) != kEndings.end();
}

}  // namespace

std::vector<fs::path> list_frames(const std::vector<fs::path>& paths) {
  std::vector<fs::path> frames;
  for (const fs::path& path : paths) {
    if (!is_folder(path)) {
      frames.push_back(path);
      continue;
    }
    const std::vector<fs::path> in_folder = sensing::list_images(path);
    frames.insert(frames.end(), in_folder.begin(), in_folder.end());
  }
  return frames;
}

std::vector<fs::path> list_meshes(const fs::path& folder) {
  std::vector<fs::path> meshes;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!is_hidden(entry.path()) && may_be_mesh(entry.path()) && entry.is_regular_file())
      meshes.push_back(entry.path());
  }
  std::ranges::sort(meshes, comes_before);
  return meshes;
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

std::vector<std::string> reason_words() {
  std::vector<std::string> words;
  for (int code = 0; code < sensing::kReasonCount; ++code) {
    std::string word(sensing::name(static_cast<sensing::Reason>(code)));
    std::replace(word.begin(), word.end(), '_', ' ');
    words.push_back(std::move(word));
  }
  return words;
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

fs::path noise_beside(const fs::path& range_map) {
  const auto beside = [&](const char* ending) {
    return range_map.parent_path() / (range_map.stem().string() + ending);
  };
  const fs::path noise = beside("_noise.tiff");
  return is_there(noise) ? noise : beside("_sigma.tiff");
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

void check_camera_options(const fs::path& path, const MapCamera& camera) {
  geometry::check_selection(camera.selection);
  if (!camera.mask.empty()) (void)is_folder(camera.mask);  // refuses a missing one
  if (is_range_map(path)) {
    if (!camera.scale && camera.intrinsics.empty()) return;
    throw InvalidInput(path.string() + ": " + (camera.scale ? "--scale" : "--intrinsics") +
                       " works for depth images (16-bit PNG), which this is not");
  }
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

sensing::Rig load_rig(const fs::path& path) {
  sensing::Rig rig = sensing::read_rig(path);
  tell_doubts(path.string(), sensing::rig_doubts(rig));
  return rig;
}

void tell_doubts(const std::string& source, const std::vector<sensing::Doubt>& doubts) {
  if (const std::string why = sensing::impossible_parts(doubts); !why.empty())
    throw InvalidInput(source + ": " + why + ".");
  static std::mutex mutex;  // frames of a sequence are read at the same time
  static std::set<std::string> told;
  const std::scoped_lock lock(mutex);
  for (const sensing::Doubt& doubt : doubts) {
    if (told.insert(doubt.subject).second) spdlog::warn("{}: {}.", source, doubt.message);
  }
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found)
    throw FileError(path.string() + ": there is no such file or folder.");
  if (error) throw FileError(path.string() + ": cannot be read: " + error.message() + ".");
  return fs::is_directory(status);
}

bool is_there(const fs::path& path) {
  std::error_code cannot_look;
  return fs::exists(path, cannot_look);
}

bool is_image(const fs::path& path) {
  return lower_extension(path) == ".png" || is_range_map(path);
}

bool is_range_map(const fs::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".tiff" || extension == ".tif";
}

bool is_sigma(const fs::path& path) {
  return path.filename().string().ends_with("_sigma.tiff") || is_noise(path);
}

bool is_noise(const fs::path& path) { return path.filename().string().ends_with("_noise.tiff"); }

bool is_reasons(const fs::path& path) {
  return path.filename().string().ends_with("_reasons.tiff");
}

}  // namespace palpate::apps
