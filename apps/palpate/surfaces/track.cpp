// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/surface_tracker.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "shared/result_folder.h"
#include "shared/surface_colors.h"
#include "surfaces/range_map_feed.h"
#include "surfaces/tool_places.h"
#include "surfaces/track_outputs.h"
#include "surfaces/track_record.h"

namespace palpate::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// For an object that a campaign presses. On an elastic body of 80 mm seen by the bundled rig,
/// 0.001 to 0.01 give errors within a tenth of each other.
constexpr double kHeld = 0.003;
/// For the same object: its dents are small, and decoded depths have little noise.
constexpr double kHeldStiffness = 0.01;

struct TrackCall {
  fs::path input, reference, acquisition, output;
  fs::path color_images;  ///< folder; empty: depths alone
  MapCamera camera;
  geometry::ReadOptions meshes;
  geometry::TrackingOptions tracking;
  TrackOutputs outputs;          ///< in the folder where this run writes, for `output`
  std::optional<double> follow;  ///< [s] how long to wait for a further range map
  bool resume = false;
};

/// The surface to track, and the file that it comes from.
struct Reference {
  fs::path file;
  geometry::TriangleMesh mesh;
  geometry::Attributes colors = {};  ///< of the vertices, from --color-images
};

Reference load_reference(const TrackCall& call, const fs::path& first_map) {
  Reference reference{.file = call.reference.empty() ? first_map : call.reference, .mesh = {}};
  if (is_image(reference.file)) {
    check_has_no_unit(reference.file, call.meshes);
    const geometry::RangeMap map = load_range_map(reference.file, call.camera);
    reference.mesh = geometry::mesh_range_map(map).mesh;
    if (!call.color_images.empty() && call.reference.empty()) {
      reference.colors = colors_in(call.color_images, reference.file, reference.mesh.vertices,
                                   map.camera, call.camera);
    }
  } else {
    reference.mesh = geometry::read_mesh(reference.file, call.meshes);
  }
  if (reference.mesh.triangles.cols() == 0) {
    throw InvalidInput(reference.file.string() +
                       (is_image(reference.file)
                            ? ": no two neighbouring pixels have a depth; there is no surface to "
                              "track. Give one with --reference."
                            : ": has no triangles; there is no surface to track."));
  }
  return reference;
}

/// The fingerprint of a range map, and of its mask and its picture.
std::string content_of(const TrackCall& call, const fs::path& range_map) {
  std::string content = file_fingerprint(range_map);
  if (!call.camera.mask.empty())
    content += file_fingerprint(mask_file(range_map, call.camera.mask));
  if (!call.color_images.empty()) {
    try {
      content += file_fingerprint(picture_of(call.color_images, range_map, call.camera));
    } catch (const FileError&) {
      content += "none";  // a frame that is lost needs no picture
    }
  }
  return text_fingerprint(content);
}

/// All that the meshes depend on besides the range maps, their masks and their pictures.
Json settings_of(TrackCall call, const fs::path& reference, const fs::path& first_map) {
  const bool needs_rig = call.camera.intrinsics.empty();
  Json settings = {
      {"version", PALPATE_VERSION},
      {"--reference", file_fingerprint(reference)},
      {"--acquisition", call.acquisition.empty() ? "" : file_fingerprint(call.acquisition)},
      {"--color-images", call.color_images.string()},
      {"--unit", call.meshes.unit.value_or(0)},
      {"--rig", needs_rig ? file_fingerprint(rig_of(first_map, call.camera.rig)) : ""},
      {"--scale", call.camera.scale.value_or(0)},
      {"--intrinsics", call.camera.intrinsics},
      {"--format", call.outputs.format}};
  settings.update(option_values(fields_of(call.tracking)));
  settings.update(option_values(fields_of(call.camera.selection)));
  settings["--mask"] = call.camera.mask.string();
  return settings;
}

/// Returns the surface in a range map; or reports and returns why it is lost.
/// \throws InvalidInput if the first surface that was measured is not at the reference.
geometry::TrackedSurface track_one(const TrackCall& call, const Reference& reference,
                                   ToolPlaces& tool, const fs::path& file,
                                   geometry::SurfaceTracker& tracker) {
  const auto lost = [](const std::string& why) {
    spdlog::error("{}", why);
    geometry::TrackedSurface none;
    none.lost = why;
    return none;
  };
  geometry::RangeMap map;
  try {
    map = load_range_map(file, call.camera);
  } catch (const InvalidInput& error) {
    return lost(error.what());
  }
  if (!(map.z > 0).any()) return lost(file.string() + ": no pixel has a depth");
  geometry::ImageF image;  // to follow the texture in
  if (!call.color_images.empty())
    image = intensities_in(call.color_images, file, map.camera, call.camera);
  geometry::TrackedSurface found = tracker.track(map, tool.in(file), image);
  if (found.lost.empty()) return found;
  if (!tracker.has_start()) {
    throw InvalidInput(fmt::format(
        "{}: does not lie at the pose of the first frame, {}: {}. Give a reference at that pose, "
        "or move it there: palpate compare {} {} --align -o aligned.ply",
        reference.file.string(), file.string(), found.lost, reference.file.string(),
        file.string()));
  }
  return lost(file.string() + ": " + found.lost);
}

/// Tracks the frames that are not kept, and adds them to the record.
/// \return [s] the time for these.
double track_all(const TrackCall& call, RangeMapFeed& feed, const Reference& reference,
                 const ResultFolder& folder, TrackRecord& record) {
  const std::vector<TrackedFrame>& frames = record.frames();
  geometry::SurfaceTracker tracker(call.tracking, reference.mesh);
  ToolPlaces tool =
      call.acquisition.empty() ? ToolPlaces() : ToolPlaces(call.acquisition, reference.mesh);
  for (const TrackedFrame& frame : frames) {
    if (!frame.lost.empty()) spdlog::error("{}", frame.lost);
  }
  const auto is_found = [](const TrackedFrame& frame) { return frame.lost.empty(); };
  const auto first = std::ranges::find_if(frames, is_found);
  if (first != frames.end() && !call.color_images.empty()) {
    // The first frame gives the texture.
    const auto index = static_cast<std::size_t>(first - frames.begin());
    (void)track_one(call, reference, tool, feed.known()[index], tracker);
  }
  const auto last = std::find_if(frames.rbegin(), frames.rend(), is_found);
  if (last != frames.rend())
    tracker.start_from(read_node_motions(nodes_file(call.outputs, last->range_map),
                                         tracker.graph().nodes().cols()));
  Progress progress("tracking");
  const InterruptMessage message({});
  const auto show = [&] {
    InterruptMessage::set_kept(folder.what_is_kept(record.written(), feed.known().size()));
    progress.show(frames.size(), feed.known().size());
  };
  show();
  Clock::duration spent{};
  while (feed.wait_for(frames.size(), show)) {
    const fs::path file = feed.known()[frames.size()];
    const Clock::time_point start = Clock::now();
    const geometry::TrackedSurface found = track_one(call, reference, tool, file, tracker);
    record.add({.range_map = file.filename().string(),
                .fingerprint = content_of(call, file),
                .lost = found.lost,
                .figures = found.figures});
    const bool was_found = found.lost.empty();
    // Before the first frame is found, nothing is written: the call may be wrong.
    if (tracker.has_start()) {
      if (record.written() == record.kept()) folder.begin();
      record.begin();
      if (was_found) write_outputs(call.outputs, file, reference.colors, tracker.graph(), found);
      record.write();
    }
    if (was_found) {
      spdlog::info("{}: RMS {:.3f} mm, {:.1f} % of the vertices measured, {} iterations{}",
                   file.string(), found.figures.rms, 100 * found.figures.measured,
                   found.figures.iterations, found.figures.settled ? "" : ", not settled");
    }
    spent += Clock::now() - start;
    show();
  }
  return std::chrono::duration<double>(spent).count();
}

/// Warns if the range maps hardly show tangential motion of the surface.
/// \param sigma [mm] median deviation of vertices along the surface
/// \param noise [mm]
void doubt_motion_along(double sigma, double noise, bool has_images) {
  // Smooth surfaces have 12 and more, relief 1 to 8, texture 0.2.
  constexpr double kVague = 10;
  if (!(sigma > kVague * noise)) return;
  spdlog::warn(
      "the surface follows the range maps, but they hardly show how it moves along itself (the "
      "standard deviation of vertices along it is {:.2g} mm in the median, more than {:g} times "
      "the distances from the range maps): there is too little relief or texture, or too much "
      "noise. Vertices move along it with the least distortion, and need not stay at the same "
      "point of the object{}",
      sigma, kVague,
      has_images ? "" : ". Give pictures of its texture, if it has one (--color-images)");
}

/// \param seconds time for the frames that were not kept.
void report(const Settings& settings, const TrackCall& call, const TrackRecord& record,
            const geometry::TriangleMesh& mesh, double seconds) {
  const std::vector<TrackedFrame>& frames = record.frames();
  Json per_frame = Json::array();
  std::string prose;
  std::vector<std::string> lost;
  std::vector<double> rms, noise, across, along;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const TrackedFrame& frame = frames[i];
    Json& entry = per_frame.emplace_back(to_json(frame));
    entry["kept"] = i < record.kept();
    if (!frame.lost.empty()) {
      lost.push_back(frame.range_map);
      prose += fmt::format("{}: lost\n", frame.range_map);
      continue;
    }
    const std::string file = (call.output / mesh_name(call.outputs, frame.range_map)).string();
    entry["file"] = file;
    const geometry::TrackingFigures& figures = frame.figures;
    rms.push_back(figures.rms);
    // A range map gives no new information on the surface that is made from it.
    if (i > 0 || !call.reference.empty()) {
      noise.push_back(figures.rms);
      across.push_back(figures.sigma_across);
      along.push_back(figures.sigma_along);
    }
    prose += fmt::format(
        "{} -> {}: RMS {:.3f} mm, 95 % within {:.3f} mm, largest {:.3f} mm; {:.1f} % of the "
        "vertices measured{}{}\n",
        frame.range_map, file, figures.rms, figures.p95, figures.max, 100 * figures.measured,
        figures.settled ? "" : "; not settled",
        i < record.kept() ? "; kept from an earlier run" : "");
  }
  const geometry::ErrorStatistics of_rms = geometry::error_statistics(rms);
  const double sigma_across = geometry::error_statistics(across).median;
  const double sigma_along = geometry::error_statistics(along).median;
  // For maps without noise, the distances are too small for this judgement.
  doubt_motion_along(sigma_along, std::max(geometry::error_statistics(noise).median, sigma_across),
                     !call.color_images.empty());
  const std::string deviations =
      along.empty() ? ""
                    : fmt::format(
                          "; standard deviation of the vertices {:.2g} mm across the "
                          "surface, {:.2g} mm along it",
                          sigma_across, sigma_along);
  const double done = static_cast<double>(frames.size() - record.kept());
  print(settings,
        {{"range_maps", frames.size()},
         {"meshes", rms.size()},
         {"kept", record.kept()},
         {"lost", lost},
         {"vertices", mesh.vertices.cols()},
         {"triangles", mesh.triangles.cols()},
         {"median_rms", of_rms.median},
         {"largest_rms", of_rms.max},
         {"median_sigma_across", sigma_across},
         {"median_sigma_along", sigma_along},
         {"seconds_per_frame", seconds / done},
         {"per_frame", per_frame}},
        prose + fmt::format("{} of {} range maps became meshes of {} vertices and {} triangles in "
                            "{}; RMS {:.3f} mm (median of the frames), at most {:.3f} mm{}.",
                            rms.size(), frames.size(), mesh.vertices.cols(), mesh.triangles.cols(),
                            call.output.string(), of_rms.median, of_rms.max, deviations));
  if (!lost.empty()) {
    throw Error(fmt::format("{} of {} frames were lost ({}); the others have their meshes.",
                            lost.size(), frames.size(), fmt::join(lost, ", ")));
  }
}

/// The first range map gives camera and reference.
void wait_for_first(RangeMapFeed& feed, const TrackCall& call) {
  if (!call.follow) return;
  spdlog::info("waiting up to {:g} s for range maps in {}", *call.follow, call.input.string());
  static_cast<void>(feed.wait_for(0, [] {}));
}

void track(const Settings& settings, TrackCall call) {
  if (!is_folder(call.input)) {
    throw InvalidInput(call.input.string() +
                       ": is a file; give a folder of range maps, as palpate decode writes them, "
                       "or of depth images.");
  }
  RangeMapFeed feed(call.input, call.camera, call.follow);
  check_output_folder(
      {call.input, call.reference, call.acquisition, call.camera.rig, call.camera.mask},
      call.output);
  wait_for_first(feed, call);
  const std::vector<fs::path> maps = feed.known();
  if (maps.size() == 1 && !call.follow) {
    spdlog::warn("{}: is the only frame in {}; a motion takes more", maps.front().string(),
                 call.input.string());
  }
  check_camera_options(maps.front(), call.camera);
  const Reference reference = load_reference(call, maps.front());
  using enum ResultFolder::Unfinished;
  ResultFolder folder(call.output, tracked_files, call.resume ? resumed : kept);
  call.outputs.folder = folder.place();
  TrackRecord record(folder.place(), settings_of(call, reference.file, maps.front()), maps);
  if (call.resume) {
    record.resume([&](const TrackedFrame& frame, const fs::path& range_map) {
      return frame.fingerprint == content_of(call, range_map) && has_outputs(call.outputs, frame);
    });
  }
  double seconds = 0;
  try {
    seconds = track_all(call, feed, reference, folder, record);
  } catch (const OutputError&) {
    spdlog::warn("{}", folder.what_is_kept(record.written(), feed.known().size()));
    throw;
  }
  std::set<std::string> found;
  for (const TrackedFrame& frame : record.frames())
    if (frame.lost.empty()) found.insert(fs::path(frame.range_map).stem().string());
  if (found.empty()) throw FileError(record.frames().front().lost);
  folder.finish([&](const fs::path& file) { return found.contains(file.stem().string()); });
  report(settings, call, record, reference.mesh, seconds);
}

}  // namespace

void add_track(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<TrackCall>();
  CLI::App* command = app.add_subcommand(
      "track", "Track a surface through range maps: one mesh per frame, with the same triangles");
  add_required(*command, "RANGE_FOLDER", call->input,
               "Folder of range maps (TIFF) or depth images (16-bit PNG) of one camera");
  command->add_option(
      "--reference", call->reference,
      "Mesh, range map or depth image of the surface to track, at its pose in the first frame "
      "(default: the first range map)");
  command->add_option(
      "--color-images", call->color_images,
      "Folder of colour or grey images that are aligned with the depths, to follow the texture of "
      "the surface: NAME.png, .jpg or .tiff for each range map or depth image NAME, or "
      "NAME_color.png as decode --surface-color writes it. Meshes have the colours of the first");
  add_camera_options(*command, call->camera);
  add_selection_options(*command, call->camera);
  add_unit_option(*command, call->meshes);
  add_required(*command, "-o,--output", call->output, "Folder for the meshes");
  add_word(*command, "--format", call->outputs.format, {"ply", "obj"},
           "Format of the meshes: ply or obj")
      ->capture_default_str();
  add_fields(*command, fields_of(call->tracking));
  command->add_option(
      "--acquisition", call->acquisition,
      "Campaign of the range maps (acquisition.db of palpate probe run --camera). Its samples give "
      "the position of each contact, which the tool hides in the range map. Implies "
      "--from-reference, --hold 0.003 and --stiffness 0.01 unless these are given");
  command->add_flag("--pictures", call->outputs.pictures,
                    "Also draw each mesh coloured by its distance from the range map (PNG)");
  add_number(*command, "--follow", call->follow, above(0).finite(),
             "Also track range maps that another program adds to the folder, until none has come "
             "for this time [s]");
  command->add_flag("--resume", call->resume,
                    "Keep the frames that an earlier run with the same settings finished in this "
                    "folder");
  command->footer(
      "The reference is deformed to lie on each range map in turn. All meshes have the triangles "
      "and the vertex\norder of the reference. A vertex stays at the same point of the object "
      "where relief or texture (--color-images) shows how\nthe surface moves along itself; on a "
      "plane, a sphere or another smooth shape, range maps do not show it, and vertices\nmove with "
      "the least distortion.\n"
      ".ply files also contain the distance of each vertex from the range map (NaN where nothing "
      "was measured), and the\nstandard deviation of its position in mm, across the surface "
      "(sigma_across) and along it (sigma_along: large\nwhere nothing shows this motion).\n"
      "A frame that is broken or lost gets no mesh, the next one starts from the last frame that "
      "was tracked, and the exit\nstatus is 1. track.jsonl contains the figures of each frame, "
      "nodes/ the data for --resume. Results of an earlier run in\nthe folder are replaced "
      "completely, when all frames are tracked, unless --resume is given; Ctrl-C keeps what is "
      "finished.\n"
      "Examples:\n  palpate track range/ -o meshes/\n"
      "  palpate mesh range/000000.tiff --fill-holes 10 --tolerance 0.2 -o reference.ply\n"
      "  palpate track range/ --reference reference.ply -o meshes/ --format obj --resume\n"
      "  palpate track range/ --reference surface.ply --acquisition acquisition.db -o meshes/\n"
      "  palpate track depth/ --scale 1 --intrinsics 600,600,320,240 --color-images color/ -o "
      "meshes/");
  command->callback([call, command, &settings] {
    if (!call->acquisition.empty()) {
      call->tracking.from_reference = true;
      const auto is_given = [&](const char* name) { return command->count(name) > 0; };
      if (!is_given("--hold")) call->tracking.hold = kHeld;
      if (!is_given("--stiffness")) call->tracking.stiffness = kHeldStiffness;
    }
    track(settings, *call);
  });
}

}  // namespace palpate::apps
