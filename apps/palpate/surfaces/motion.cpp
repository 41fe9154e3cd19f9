// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/surface_strain.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "surfaces/frame_motion.h"
#include "surfaces/motion_sequence.h"

namespace palpate::apps {
namespace {

constexpr const char* kSeries = "motion.vtk.series";
// The largest and the smallest stretch of a frame are those of this share of the vertices: single
// ones at the border are often wrong.
constexpr double kMostVertices = 0.99;

struct MotionCall {
  fs::path input, reference, output;
  std::string format = "ply";
  std::optional<double> rate;    // [Hz] frames
  std::optional<double> window;  // [s], or frames without a rate; no smoothing without it
  double radius = 0;             // [mm]
};

struct FrameFigures {
  std::string file = {};
  double time = 0;                                // [s], or frames without a rate
  double displacement = 0, displacement_max = 0;  // [mm] RMS, largest
  double stretch_max = 0, stretch_min = 0;        // 99 % and 1 % of the vertices are between
  double area = 0;                                // of the surface, relative to the reference
  // [mm] Median standard deviation of the smoothed positions; NaN if they are not smoothed.
  double sigma = std::numeric_limits<double>::quiet_NaN();
};

// Quantile of the known values.
double known_quantile(const Eigen::VectorXd& values, double share) {
  std::vector<double> known;
  for (const double value : values)
    if (std::isfinite(value)) known.push_back(value);
  if (known.empty()) return std::numeric_limits<double>::quiet_NaN();
  return quantile(known, share);
}

void add(geometry::Attributes& attributes, const std::string& name, const auto& values) {
  std::vector<float> numbers;
  for (const double value : values) numbers.push_back(static_cast<float>(value));
  geometry::set_attribute(attributes,
                          {.name = name, .values = std::move(numbers), .list_sizes = {}});
}

void add_vector(geometry::Attributes& attributes, const std::string& name,
                const Eigen::Matrix3Xd& values) {
  constexpr std::array<const char*, 3> kAxes{"_x", "_y", "_z"};
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    add(attributes, name + kAxes[static_cast<std::size_t>(axis)],
        Eigen::VectorXd(values.row(axis).transpose()));
}

std::string mesh_name(const MotionCall& call, const MotionFrame& frame) {
  return frame.file.stem().string() + "." + call.format;
}

// Adds the quantities of motion to the attributes of a mesh.
FrameFigures describe(const MotionCall& call, const geometry::TriangleMesh& reference,
                      bool has_seconds, FrameMotion& motion) {
  geometry::MeshFile& frame = motion.frame;
  const Eigen::Matrix3Xd displacement = frame.mesh.vertices - reference.vertices;
  const geometry::SurfaceStrain strain =
      geometry::surface_strain(reference, frame.mesh.vertices, call.radius);
  geometry::Attributes& attributes = frame.vertex_attributes;
  const Eigen::VectorXd distances = displacement.colwise().norm();
  add(attributes, "displacement", distances);
  add_vector(attributes, "displacement", displacement);
  if (has_seconds && motion.velocity) {
    add(attributes, "speed", Eigen::VectorXd(motion.velocity->colwise().norm()));
    add_vector(attributes, "velocity", *motion.velocity);
  }
  if (motion.sigma.size() > 0) add(attributes, "sigma_smoothed", motion.sigma);
  add(attributes, "stretch_largest", strain.largest);
  add(attributes, "stretch_smallest", strain.smallest);
  add_vector(attributes, "stretch", strain.direction);
  add(attributes, "area_ratio", strain.area);
  return {
      .displacement = std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())),
      .displacement_max = distances.maxCoeff(),
      .stretch_max = known_quantile(strain.largest, kMostVertices),
      .stretch_min = known_quantile(strain.smallest, 1 - kMostVertices),
      .area = geometry::surface_area(frame.mesh) / geometry::surface_area(reference),
      .sigma = known_quantile(motion.sigma, 0.5)};
}

Json to_json(const FrameFigures& figures) {
  return {{"file", figures.file},
          {"time", figures.time},
          {"displacement", figures.displacement},
          {"displacement_max", figures.displacement_max},
          {"stretch_max", figures.stretch_max},
          {"stretch_min", figures.stretch_min},
          {"area_ratio", figures.area},
          {"sigma_smoothed", figures.sigma}};
}

// ParaView opens this file as one sequence.
std::string series_of(const std::vector<FrameFigures>& frames) {
  Json files = Json::array();
  for (const FrameFigures& frame : frames)
    files.push_back({{"name", fs::path(frame.file).filename().string()}, {"time", frame.time}});
  return Json{{"file-series-version", "1.0"}, {"files", files}}.dump(2) + "\n";
}

/// \param rate [1/s] of the times of frames
/// \param reference smoothed here if it is the first frame of a sequence that is to be smoothed.
std::vector<FrameFigures> write_frames(const MotionCall& call, const MotionSequence& sequence,
                                       const std::optional<double>& rate,
                                       geometry::TriangleMesh reference, const fs::path& folder) {
  const std::vector<MotionFrame>& frames = sequence.frames;
  const geometry::TriangleMesh first = reference;
  NearFrames near(sequence, rate, first);
  std::vector<bool> is_smoothed(frames.size(), false);
  if (call.window) is_smoothed = can_be_smoothed(near.times(), *call.window, rate ? "s" : "frames");
  std::vector<FrameFigures> figures;
  Progress progress("measuring motion");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FrameMotion motion =
        is_smoothed[i] ? smoothed_motion(near, i, *call.window) : motion_between(near, i);
    if (i == 0 && call.reference.empty()) reference.vertices = motion.frame.mesh.vertices;
    figures.push_back(describe(call, reference, rate.has_value(), motion));
    figures.back().file = (call.output / mesh_name(call, frames[i])).string();
    figures.back().time = near.times()[i];
    geometry::write_mesh_file(folder / mesh_name(call, frames[i]), motion.frame);
    progress.show(i + 1, frames.size());
  }
  if (call.format == "vtk") {
    write_file(folder / kSeries, [&](std::ostream& out) { out << series_of(figures); });
  }
  return figures;
}

std::string motion_in_words(const MotionCall& call, const std::vector<FrameFigures>& frames) {
  std::string words;
  for (const FrameFigures& of : frames) {
    words += fmt::format(
        "{}: displacement {:.3g} mm (RMS), at most {:.3g} mm; stretches from {:.3f} to {:.3f}; "
        "area {:.3f}{}\n",
        of.file, of.displacement, of.displacement_max, of.stretch_min, of.stretch_max, of.area,
        std::isfinite(of.sigma)
            ? fmt::format("; standard deviation after smoothing {:.2g} mm (median)", of.sigma)
            : "");
  }
  return words + fmt::format("{} meshes written to {}; stretches are those of 99 % of the vertices",
                             frames.size(), call.output.string());
}

void motion(const Settings& settings, const MotionCall& call) {
  if (!is_folder(call.input)) {
    throw InvalidInput(call.input.string() +
                       ": is a file; give a folder of meshes, as palpate track writes it");
  }
  check_output_folder({call.input, call.reference}, call.output);
  const MotionSequence sequence = motion_sequence(call.input);
  const std::optional<double> rate = frame_rate(sequence, call.rate);
  std::vector<fs::path> entries{kSeries};
  for (const MotionFrame& frame : sequence.frames) entries.push_back(mesh_name(call, frame));
  check_replaceable(call.output, entries);
  const fs::path file = call.reference.empty() ? sequence.frames.front().file : call.reference;
  const geometry::TriangleMesh reference = geometry::read_mesh(file);
  std::vector<FrameFigures> figures;
  write_folder(call.output, entries, [&](const fs::path& folder) {
    figures = write_frames(call, sequence, rate, reference, folder);
  });
  Json per_frame = Json::array();
  for (const FrameFigures& of : figures) per_frame.push_back(to_json(of));
  print(settings,
        {{"meshes", figures.size()}, {"reference", file.string()}, {"per_frame", per_frame}},
        motion_in_words(call, figures));
}

}  // namespace

void add_motion(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MotionCall>();
  CLI::App* command = app.add_subcommand(
      "motion", "Measure displacement, velocity and stretch of a tracked surface");
  add_required(*command, "MESHES", call->input,
               "Folder of meshes with the same triangles, as palpate track writes it");
  add_required(*command, "-o,--output", call->output, "Folder for the meshes with their values");
  command->add_option("--reference", call->reference,
                      "Mesh with which the others are compared (default: the first one)");
  add_number(*command, "--rate", call->rate, above(0).finite(),
             "Frames per second, for velocities; frames are numbered by their names. Names "
             "that are times in seconds, as of a recording of TUM RGB-D, replace it [Hz]");
  add_number(*command, "--window", call->window, above(0).finite(),
             "Smooth the positions over this time before and after each frame, without delay "
             "[s; frames if there is no --rate and the names are not times]");
  add_number(*command, "--radius", call->radius, at_least(0).finite(),
             "Stretches are averaged over this distance around each vertex; 0: over the "
             "vertices that share an edge [mm]")
      ->capture_default_str();
  add_word(*command, "--format", call->format, {"ply", "vtk"}, "Format of the meshes: ply or vtk")
      ->capture_default_str();
  command->footer(
      "Each mesh keeps its values and gets these at its vertices: displacement "
      "[mm] and its components;\nspeed and velocity [mm/s] with --rate, or if the names are times; "
      "stretch_largest and stretch_smallest, the principal stretches (length divided\nby length in "
      "the reference); stretch_x, _y, _z, the direction of the largest one; area_ratio.\n"
      "With --window, a parabola in time is fitted to each coordinate of a vertex: its value is "
      "the "
      "position, its slope the\nvelocity, and sigma_smoothed [mm] is the standard deviation of "
      "each "
      "coordinate.\n"
      "With --format vtk, ParaView opens motion.vtk.series as one sequence.\n"
      "Examples:\n  palpate motion meshes/ --rate 30 --window 0.15 --radius 5 -o motion/\n"
      "  palpate export motion/ --html -o motion.html");
  command->callback([call, &settings] { motion(settings, *call); });
}

}  // namespace palpate::apps
