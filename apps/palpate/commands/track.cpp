// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "commands/node_motions_file.h"
#include "commands/track_record.h"
#include "palpate/error.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/nonrigid_registration.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/pictures/draw_distances.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/fingerprint.h"
#include "shared/inputs.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// [mm] The scale of a picture goes at least so far.
constexpr double kLeastScale = 1e-3;

/// A frame with a smaller visible fraction is mostly a guess. The visible part is right however
/// little there is: with 0 to 97 % of a moving surface hidden, its vertices were 0.1 to 0.8 mm from
/// their true positions, the hidden ones 0.2 mm (10 %), 1.9 mm (30 %) and 3 to 11 mm (40 % and
/// more).
constexpr double kMinVisible = 0.3;

/// A reference that lies elsewhere is stretched to fit the relief it meets, and part of it meets
/// none. The median stretch divided by the visible fraction was 0.018 to 0.15 for references 75 to
/// 500 mm aside that were not found, and at most 0.005 for those within --reach, with up to 70 % of
/// them hidden; 0.012 for a flag that had waved by 9 mm. See docs/trade-geometry.md.
constexpr double kMaxFirstStretch = 0.015;

/// More nodes than a graph can be solved with, steps than a frame can need, and distances that
/// reach from one end of the surface to the other.
constexpr int kMostNodes = 100000;
constexpr int kMostIterations = 10000;
constexpr Interval kReaches = at_least(geometry::NonRigidOptions{}.min_correspondence).at_most(1);

struct TrackCall {
  fs::path input, reference, rig, output;
  std::string format = "ply";
  geometry::ReadOptions meshes;
  geometry::DeformationGraphOptions graph;
  geometry::NonRigidOptions registration;
  double min_visible = kMinVisible;
  double max_stretch = kMaxFirstStretch;
  bool from_reference = false;
  bool pictures = false;
  bool resume = false;
};

fs::path mesh_file(const TrackCall& call, const fs::path& range_map) {
  return call.output / (range_map.stem().string() + "." + call.format);
}
fs::path nodes_file(const TrackCall& call, const fs::path& range_map) {
  return call.output / "nodes" / (range_map.stem().string() + ".ply");
}
fs::path picture_file(const TrackCall& call, const fs::path& range_map) {
  return call.output / (range_map.stem().string() + ".png");
}

bool is_complete(const TrackCall& call, const TrackedFrame& frame) {
  return !frame.lost.empty() || (is_there(mesh_file(call, frame.range_map)) &&
                                 is_there(nodes_file(call, frame.range_map)) &&
                                 (!call.pictures || is_there(picture_file(call, frame.range_map))));
}

/// The surface to track, and the file that it comes from.
struct Reference {
  fs::path file;
  geometry::TriangleMesh mesh;
};

Reference load_reference(const TrackCall& call, const fs::path& first_map) {
  Reference reference{.file = call.reference.empty() ? first_map : call.reference, .mesh = {}};
  if (is_range_map(reference.file)) {
    if (call.meshes.unit) {
      throw InvalidInput(reference.file.string() +
                         ": --unit is for mesh files; range maps are in mm");
    }
    reference.mesh = geometry::mesh_range_map(load_range_map(reference.file, call.rig)).mesh;
  } else {
    reference.mesh = geometry::read_mesh(reference.file, call.meshes);
  }
  if (reference.mesh.triangles.cols() == 0) {
    throw InvalidInput(reference.file.string() +
                       (is_range_map(reference.file)
                            ? ": no two neighbouring pixels have a depth; there is no surface to "
                              "track. Give one with --reference."
                            : ": has no triangles; there is no surface to track."));
  }
  return reference;
}

/// All that the meshes depend on besides the range maps.
nlohmann::ordered_json settings_of(const TrackCall& call, const fs::path& reference,
                                   const fs::path& rig) {
  return {{"version", PALPATE_VERSION},
          {"--reference", fingerprint(reference)},
          {"--unit", call.meshes.unit.value_or(0)},
          {"--rig", fingerprint(rig)},
          {"--nodes", call.graph.nodes},
          {"--stiffness", call.registration.stiffness},
          {"--reach", call.registration.max_correspondence},
          {"--iterations", call.registration.max_iterations},
          {"--min-visible", call.min_visible},
          {"--max-stretch", call.max_stretch},
          {"--from-reference", call.from_reference},
          {"--format", call.format}};
}

/// Of the vertices that face the camera, the fraction that lies on the measured surface.
double visible_fraction(const geometry::DeformedSurface& surface) {
  const auto with = [&](geometry::VertexSight sight) {
    return static_cast<double>(std::ranges::count(surface.sight, sight));
  };
  const double facing =
      static_cast<double>(surface.sight.size()) - with(geometry::VertexSight::turned_away);
  return facing > 0 ? with(geometry::VertexSight::seen) / facing : 0;
}

/// Median relative change in length of the edges whose triangles lie on the measured surface; 0 if
/// there is none.
double median_stretch(const Eigen::Matrix3Xi& triangles, const Eigen::Matrix3Xd& before,
                      const geometry::DeformedSurface& now) {
  std::vector<double> stretch;
  for (const auto& corners : triangles.colwise()) {
    if (!now.distance(corners).allFinite()) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = corners[k];
      const int b = corners[(k + 1) % 3];
      const double length = (before.col(a) - before.col(b)).norm();
      if (length > 0)
        stretch.push_back((now.vertices.col(a) - now.vertices.col(b)).norm() / length - 1);
    }
  }
  return stretch.empty() ? 0 : geometry::error_statistics(std::move(stretch)).median;
}

/// Follows the surface from frame to frame.
class Tracker {
 public:
  Tracker(const TrackCall& call, geometry::TriangleMesh reference)
      : call_(call), graph_(std::move(reference), call.graph) {}

  [[nodiscard]] const geometry::DeformationGraph& graph() const { return graph_; }

  /// Goes on from a frame that an earlier run has tracked.
  void start_from(const fs::path& range_map) {
    motions_ = read_node_motions(nodes_file(call_, range_map), graph_.nodes().cols());
  }

  /// Whether a frame was found: the next one starts there.
  [[nodiscard]] bool has_start() const { return !motions_.empty(); }

  /// Finds the surface in a range map. If that is lost, the next frame starts where this one did.
  /// \throws FileError or InvalidInput if there is no such range map.
  TrackedFrame track(const fs::path& file, const geometry::RangeMap& map) {
    surface_ = geometry::register_deformed(
        graph_, map, call_.registration,
        call_.from_reference ? std::span<const Eigen::Isometry3d>() : motions_);
    TrackedFrame frame{
        .range_map = file.filename().string(), .fingerprint = fingerprint(file), .lost = {}};
    const geometry::ErrorStatistics error =
        geometry::error_statistics({surface_.distance.begin(), surface_.distance.end()});
    frame.rms = error.rms;
    frame.p95 = error.p95;
    frame.max = error.max;
    frame.measured = static_cast<double>(error.count) / static_cast<double>(surface_.sight.size());
    frame.visible = visible_fraction(surface_);
    frame.stretch = median_stretch(
        graph_.mesh().triangles,
        has_start() ? geometry::deformed_vertices(graph_, motions_) : graph_.mesh().vertices,
        surface_);
    frame.iterations = surface_.iterations;
    frame.settled = surface_.stop == geometry::NonRigidStop::converged;
    if (frame.visible < call_.min_visible) {
      frame.lost = fmt::format(
          "{:.1f} % of the vertices that face the camera lie on the measured surface; at least "
          "{:g} % must (--min-visible)",
          100 * frame.visible, 100 * call_.min_visible);
    } else if (!has_start() && frame.stretch > call_.max_stretch * frame.visible) {
      frame.lost = fmt::format(
          "to lie on the measured surface it is stretched by {:.2g} % (median of its edges); as "
          "{:.0f} % of it is visible, at most {:.2g} % is expected (--max-stretch)",
          100 * frame.stretch, 100 * frame.visible, 100 * call_.max_stretch * frame.visible);
    } else {
      motions_ = surface_.node_motions;
    }
    return frame;
  }

  /// Writes what `track` found. The record of the frame has to be written after it.
  void write(const fs::path& range_map, double rms) const {
    geometry::MeshFile mesh;
    mesh.mesh = {.vertices = surface_.vertices, .triangles = graph_.mesh().triangles};
    const auto add = [&](const char* name, const Eigen::VectorXd& values) {
      geometry::set_attribute(mesh.vertex_attributes,
                              {.name = name,
                               .values = std::vector<float>(values.begin(), values.end()),
                               .list_sizes = {}});
    };
    add("distance", surface_.distance);
    add("confidence", surface_.confidence);
    if (call_.pictures) draw(range_map, rms);
    write_node_motions(nodes_file(call_, range_map), graph_, surface_.node_motions);
    geometry::write_mesh_file(mesh_file(call_, range_map), mesh);
  }

 private:
  void draw(const fs::path& range_map, double rms) const {
    const geometry::TriangleMesh mesh{.vertices = surface_.vertices,
                                      .triangles = graph_.mesh().triangles};
    Eigen::VectorXd distances(mesh.triangles.cols());  // NaN unless all corners are measured
    for (Eigen::Index t = 0; t < distances.size(); ++t)
      distances[t] = surface_.distance(mesh.triangles.col(t)).mean();
    const geometry::ErrorStatistics error =
        geometry::error_statistics({distances.begin(), distances.end()});
    if (error.count == 0) return;
    pictures::draw_distances(
        picture_file(call_, range_map), mesh, distances,
        {.title =
             range_map.filename().string() + ": distance of the tracked surface from the range map",
         .subtitle = fmt::format("root mean square {:.3f} mm; grey was not measured", rms),
         .limit = std::max(error.p95, kLeastScale)});
  }

  const TrackCall& call_;
  geometry::DeformationGraph graph_;
  std::vector<Eigen::Isometry3d> motions_;
  geometry::DeformedSurface surface_;
};

/// The frames, and what this run has to say of them beyond the record.
struct Tracking {
  std::vector<TrackedFrame> frames;
  std::size_t kept = 0;
  double seconds = 0;  ///< for those that are not kept
};

/// \throws InvalidInput if the first surface that was measured is not where the reference lies.
TrackedFrame track_one(const TrackCall& call, const Reference& reference, const fs::path& file,
                       Tracker& tracker) {
  const auto lost = [&](const std::string& why) {
    spdlog::error("{}", why);
    return TrackedFrame{
        .range_map = file.filename().string(), .fingerprint = fingerprint(file), .lost = why};
  };
  geometry::RangeMap map;
  try {
    map = load_range_map(file, call.rig);
  } catch (const InvalidInput& error) {
    return lost(error.what());
  }
  if (!(map.z > 0).any()) return lost(file.string() + ": no pixel has a depth");
  TrackedFrame frame = tracker.track(file, map);
  if (frame.lost.empty()) return frame;
  if (!tracker.has_start()) {
    throw InvalidInput(fmt::format(
        "{}: does not lie at the pose of the first frame, {}: {}. Give a reference at that pose, "
        "or move it there: palpate compare {} {} --align -o aligned.ply",
        reference.file.string(), file.string(), frame.lost, reference.file.string(),
        file.string()));
  }
  return lost(file.string() + ": " + frame.lost);
}

Tracking track_all(const TrackCall& call, const std::vector<fs::path>& maps,
                   const Reference& reference, TrackRecord& record) {
  Tracker tracker(call, reference.mesh);
  Tracking tracking{.frames = record.kept(), .kept = record.kept().size(), .seconds = 0};
  for (const TrackedFrame& frame : tracking.frames) {
    if (!frame.lost.empty()) spdlog::error("{}", frame.lost);
  }
  const auto last = std::find_if(tracking.frames.rbegin(), tracking.frames.rend(),
                                 [](const TrackedFrame& frame) { return frame.lost.empty(); });
  if (last != tracking.frames.rend()) tracker.start_from(last->range_map);
  Progress progress("tracking");
  const auto show = [&] {
    progress.show(static_cast<int>(tracking.frames.size()), static_cast<int>(maps.size()));
  };
  show();
  std::size_t recorded = tracking.kept;
  const Clock::time_point start = Clock::now();
  while (tracking.frames.size() < maps.size()) {
    const fs::path& file = maps[tracking.frames.size()];
    tracking.frames.push_back(track_one(call, reference, file, tracker));
    const TrackedFrame& frame = tracking.frames.back();
    // Before a frame is found nothing is written: the call may be wrong.
    if (tracker.has_start()) {
      record.begin();
      if (frame.lost.empty()) tracker.write(file, frame.rms);
      while (recorded < tracking.frames.size()) record.add(tracking.frames[recorded++]);
    }
    if (frame.lost.empty()) {
      spdlog::info("{}: RMS {:.3f} mm, {:.1f} % of the vertices measured, {} iterations{}",
                   file.string(), frame.rms, 100 * frame.measured, frame.iterations,
                   frame.settled ? "" : ", not settled");
    }
    show();
  }
  tracking.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return tracking;
}

void report(const Settings& settings, const TrackCall& call, const Tracking& tracking,
            const geometry::TriangleMesh& mesh) {
  nlohmann::ordered_json per_frame = nlohmann::ordered_json::array();
  nlohmann::ordered_json lost = nlohmann::ordered_json::array();
  std::string prose, lost_names;
  std::vector<double> rms;
  for (std::size_t i = 0; i < tracking.frames.size(); ++i) {
    const TrackedFrame& frame = tracking.frames[i];
    nlohmann::ordered_json entry = to_json(frame);
    entry["kept"] = i < tracking.kept;
    if (frame.lost.empty()) {
      const std::string file = mesh_file(call, frame.range_map).string();
      entry["file"] = file;
      rms.push_back(frame.rms);
      prose += fmt::format(
          "{} -> {}: RMS {:.3f} mm, 95 % within {:.3f} mm, largest {:.3f} mm; {:.1f} % of the "
          "vertices measured{}{}\n",
          frame.range_map, file, frame.rms, frame.p95, frame.max, 100 * frame.measured,
          frame.settled ? "" : "; not settled",
          i < tracking.kept ? "; kept from an earlier run" : "");
    } else {
      lost.push_back(frame.range_map);
      lost_names += (lost_names.empty() ? "" : ", ") + frame.range_map;
      prose += fmt::format("{}: lost\n", frame.range_map);
    }
    per_frame.push_back(std::move(entry));
  }
  const geometry::ErrorStatistics of_rms = geometry::error_statistics(rms);
  const double done = static_cast<double>(tracking.frames.size() - tracking.kept);
  print(
      settings,
      {{"range_maps", tracking.frames.size()},
       {"meshes", rms.size()},
       {"kept", tracking.kept},
       {"lost", lost},
       {"vertices", mesh.vertices.cols()},
       {"triangles", mesh.triangles.cols()},
       {"median_rms", of_rms.median},
       {"largest_rms", of_rms.max},
       {"seconds_per_frame", tracking.seconds / done},
       {"per_frame", per_frame}},
      prose + fmt::format("{} of {} range maps became meshes of {} vertices and {} triangles in "
                          "{}; RMS {:.3f} mm (median of the frames), at most {:.3f} mm.",
                          rms.size(), tracking.frames.size(), mesh.vertices.cols(),
                          mesh.triangles.cols(), call.output.string(), of_rms.median, of_rms.max));
  if (!lost.empty()) {
    throw Error(fmt::format("{} of {} frames were lost ({}); the others have their meshes.",
                            lost.size(), tracking.frames.size(), lost_names));
  }
}

/// \throws FileError if no file in the folder is a range map by its name.
void check_has_range_map(const fs::path& folder) {
  const fs::directory_iterator entries(folder);
  if (std::none_of(begin(entries), end(entries),
                   [](const fs::directory_entry& entry) { return is_range_map(entry.path()); })) {
    throw FileError(folder.string() +
                    ": there is no range map in it; expected a folder of range maps (tiff), as "
                    "palpate decode writes them.");
  }
}

void track(const Settings& settings, const TrackCall& call) {
  if (!is_folder(call.input)) {
    throw InvalidInput(call.input.string() +
                       ": is a file; give a folder of range maps, as palpate decode writes them.");
  }
  check_has_range_map(call.input);
  const std::vector<fs::path> maps = list_range_maps(call.input);
  check_output_folder({call.input, call.reference, call.rig}, call.output);
  const fs::path rig = rig_of(maps.front(), call.rig);
  const Reference reference = load_reference(call, maps.front());
  TrackRecord record(call.output, settings_of(call, reference.file, rig), maps);
  record.check_folder();
  if (call.resume)
    record.resume([&](const TrackedFrame& frame) { return is_complete(call, frame); });
  const Tracking tracking = track_all(call, maps, reference, record);
  const bool is_lost = std::ranges::none_of(
      tracking.frames, [](const TrackedFrame& frame) { return frame.lost.empty(); });
  if (is_lost) throw FileError(tracking.frames.front().lost);
  report(settings, call, tracking, reference.mesh);
}

}  // namespace

void add_track(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<TrackCall>();
  call->registration.min_matched = 0;  // --min-visible decides
  CLI::App* command = app.add_subcommand(
      "track", "Track a surface through range maps: one mesh per frame, with the same triangles");
  command->add_option("RANGE_FOLDER", call->input, "Folder of range maps (TIFF) of one camera")
      ->required();
  command->add_option("--reference", call->reference,
                      "Mesh or range map of the surface to track, at its pose in the first frame "
                      "(default: the first range map)");
  command->add_option("--rig", call->rig, "Rig of the range maps (default: rig.yaml beside them)");
  add_unit_option(*command, call->meshes);
  command->add_option("-o,--output", call->output, "Folder for the meshes")->required();
  command->add_option("--format", call->format, "Format of the meshes: ply or obj")
      ->check(CLI::IsMember({"ply", "obj"}))
      ->capture_default_str();
  command
      ->add_option("--nodes", call->graph.nodes,
                   "Number of nodes that deform the surface; more follow smaller dents and take "
                   "longer")
      ->check(within(at_least(1).at_most(kMostNodes)))
      ->capture_default_str();
  command
      ->add_option("--stiffness", call->registration.stiffness,
                   "Resistance of the surface to deformation: a low value follows small dents and "
                   "noise, a high one bridges holes smoothly")
      ->check(within(above(0).finite()))
      ->capture_default_str();
  command
      ->add_option("--reach", call->registration.max_correspondence,
                   "Largest distance of the surface from the reference in the first frame, as a "
                   "fraction of the reference's diagonal; from frame to frame it may move by about "
                   "a third of it")
      ->check(within(kReaches))
      ->capture_default_str();
  command
      ->add_option("--iterations", call->registration.max_iterations,
                   "Largest number of registration steps per frame")
      ->check(within(at_least(1).at_most(kMostIterations)))
      ->capture_default_str();
  command
      ->add_option("--min-visible", call->min_visible,
                   "A frame is lost if a smaller fraction of the vertices that face the camera "
                   "lies on the measured surface")
      ->check(within(at_least(0).at_most(1)))
      ->capture_default_str();
  command
      ->add_option(
          "--max-stretch", call->max_stretch,
          "The reference is refused if its edges must be stretched by more than this fraction "
          "(median), times its visible fraction, to lie on the first range map")
      ->check(within(at_least(0).finite()))
      ->capture_default_str();
  command->add_flag("--from-reference", call->from_reference,
                    "Start every frame from the reference instead of the previous frame: errors do "
                    "not accumulate, but the surface has to stay within --reach of the reference");
  command->add_flag("--pictures", call->pictures,
                    "Also draw each mesh coloured by its distance from the range map (PNG)");
  command->add_flag("--resume", call->resume,
                    "Keep the frames that an earlier run with the same settings finished in this "
                    "folder");
  command->footer(
      "The reference is deformed to lie on each range map in turn. All meshes have the triangles "
      "and the vertex\norder of the reference, so that a vertex is the same point of the "
      "surface in all of them; .ply files also contain the\ndistance of each vertex from the range "
      "map (NaN where nothing was measured) and a confidence from 0 to 1.\n"
      "Motion along a surface without relief is not visible in range maps and is not tracked.\n"
      "A frame that is broken or lost gets no mesh, the next one starts from the last frame that "
      "was "
      "tracked, and the exit\nstatus is 1. track.jsonl contains the figures of each frame, nodes/ "
      "the data for --resume. Results of an earlier run in\nthe folder are replaced completely, "
      "unless --resume is given; Ctrl-C keeps what is finished.\n"
      "Examples:\n  palpate track range/ -o meshes/\n"
      "  palpate mesh range/000000.tiff --fill-holes 10 --tolerance 0.2 -o reference.ply\n"
      "  palpate track range/ --reference reference.ply -o meshes/ --format obj --resume");
  command->callback([call, &settings] { track(settings, *call); });
}

}  // namespace palpate::apps
