// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/pictures/draw_mesh.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "shared/scan_registration.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

struct FuseCall {
  std::vector<fs::path> inputs, poses;
  fs::path output, picture;
  MapCamera camera;
  geometry::ReadOptions meshes;
  ScanRegistration registration;
  geometry::MergeScansOptions options;
  bool force = false;  ///< fuse scans that disagree
};

/// The files of all scans: range maps, also of folders, or meshes.
std::vector<fs::path> list_scans(const FuseCall& call) {
  const fs::path& first = call.inputs.front();
  if (is_folder(first) || is_range_map(first) || is_image(first)) {
    std::vector<fs::path> maps = list_range_maps(call.inputs, call.camera);
    check_camera_options(maps.front(), call.camera);
    check_has_no_unit(maps.front(), call.meshes);
    return maps;
  }
  check_selects_nothing(first, call.camera);
  for (const fs::path& input : call.inputs) {
    if (is_folder(input) || is_range_map(input) || is_image(input)) {
      throw InvalidInput(input.string() + ": is not a mesh as " + first.string() +
                         " is; pass either meshes or range maps.");
    }
  }
  return call.inputs;
}

/// Reads the pose of each scan: from one file each, or from files of a folder by the scans' names.
std::vector<Eigen::Isometry3d> read_poses(const FuseCall& call,
                                          const std::vector<fs::path>& scans) {
  std::vector<fs::path> files = call.poses;
  if (files.size() == 1 && is_folder(files.front())) {
    files.clear();
    for (const fs::path& scan : scans)
      files.push_back(call.poses.front() / (scan.stem().string() + ".txt"));
  }
  if (!files.empty() && files.size() != scans.size()) {
    throw InvalidInput(fmt::format(
        "palpate fuse: {} poses for {} scans; pass one for each scan, in the same order, a folder "
        "with a text file for each, or none.",
        files.size(), scans.size()));
  }
  std::vector<Eigen::Isometry3d> poses(scans.size(), Eigen::Isometry3d::Identity());
  for (std::size_t i = 0; i < files.size(); ++i) poses[i] = read_pose(files[i]);
  return poses;
}

/// The deviations that `decode --sigma` has written beside a range map, at the vertices of its
/// mesh: only those of the noise if they are in a separate file; scans share those of the rig.
Eigen::VectorXd read_sigma(const fs::path& map, const geometry::RangeMapMesh& meshed) {
  const fs::path file = noise_beside(map);
  if (!is_range_map(map) || !is_there(file)) return {};
  const geometry::ImageF sigma = geometry::read_depth_tiff(file);
  if (sigma.cols() != meshed.width || sigma.rows() != meshed.height) {
    throw FileError(fmt::format("{}: is {} x {} px; its range map is {} x {} px", file.string(),
                                sigma.cols(), sigma.rows(), meshed.width, meshed.height));
  }
  Eigen::VectorXd at_vertices(static_cast<Eigen::Index>(meshed.source.size()));
  for (std::size_t v = 0; v < meshed.source.size(); ++v) {
    const float value = sigma.reshaped<Eigen::RowMajor>()[meshed.source[v]];
    if (!(value > 0)) {
      throw FileError(fmt::format(
          "{}: the pixel in column {}, row {} has a depth and no deviation > 0", file.string(),
          meshed.source[v] % meshed.width, meshed.source[v] / meshed.width));
    }
    at_vertices[static_cast<Eigen::Index>(v)] = value;
  }
  return at_vertices;
}

/// Reads a scan. Returns nullopt, and reports it, if a range map of a folder cannot be read; files
/// that are named one by one must be valid.
/// \param broken gets a description of the fault.
std::optional<geometry::Scan> read_scan(const FuseCall& call, const fs::path& file,
                                        std::vector<std::string>& broken) {
  if (!is_range_map(file) && !is_image(file))
    return geometry::Scan{.mesh = geometry::read_mesh(file, call.meshes)};
  geometry::RangeMapMesh meshed;
  try {
    meshed = geometry::mesh_range_map(load_range_map(file, call.camera));
    if (meshed.mesh.triangles.cols() == 0)
      throw InvalidInput(file.string() + ": no two neighbouring pixels have a depth.");
  } catch (const InvalidInput& error) {
    if (std::ranges::none_of(call.inputs, is_folder)) throw;
    spdlog::error("{}", error.what());
    broken.push_back(error.what());
    return std::nullopt;
  }
  Eigen::VectorXd sigma = read_sigma(file, meshed);
  return geometry::Scan{.mesh = std::move(meshed.mesh),
                        .sigma = std::move(sigma),
                        .viewpoint = Eigen::Vector3d::Zero()};
}

/// Refuses scans that disagree where they overlap, unless the call has --force.
/// \return the pairs that disagree, with the names of their files.
Json refuse_conflicts(const FuseCall& call, const geometry::MergedScans& merged,
                      const std::vector<std::string>& names) {
  Json pairs = Json::array();
  const auto name = [&](int scan) { return names[static_cast<std::size_t>(scan)]; };
  for (const geometry::ScanConflict& conflict : merged.conflicts) {
    pairs.push_back({{"scan", name(conflict.scan)},
                     {"other", name(conflict.other)},
                     {"hidden", conflict.share},
                     {"depth", conflict.depth}});
  }
  if (pairs.empty()) return pairs;
  const geometry::ScanConflict& worst = merged.conflicts.front();
  const std::string found = fmt::format(
      "{} and {} disagree where they overlap: {:.0f} % of the points that the first saw lie behind "
      "the surface of the second, by {:.3g} mm (median){}",
      name(worst.scan), name(worst.other), 100 * worst.share, worst.depth,
      pairs.size() > 1 ? fmt::format("; in all, {} pairs of scans disagree", pairs.size()) : "");
  if (!call.force) {
    throw SolverError(
        found +
        ". The object moved, the scans show different scenes, or poses are wrong. "
        "Fuse only scans of an object that does not move, pass their poses with --pose "
        "or find them with --register; --force fuses these nevertheless");
  }
  spdlog::warn("{}.", found);
  return pairs;
}

geometry::MeshFile mesh_file(const geometry::MergedScans& merged) {
  geometry::MeshFile file;
  file.mesh = merged.mesh;
  if (merged.sigma.size() > 0) {
    const Eigen::VectorXf sigma = merged.sigma.cast<float>();
    file.vertex_attributes = {{"sigma", std::vector<float>(sigma.begin(), sigma.end()), {}}};
  }
  return file;
}

void fuse(const Settings& settings, const FuseCall& call) {
  std::vector<fs::path> inputs = call.inputs;
  inputs.insert(inputs.end(), call.poses.begin(), call.poses.end());
  check_outputs(inputs, {call.output, call.picture});
  check_pictures({call.picture});
  const std::vector<fs::path> files = list_scans(call);
  const std::vector<Eigen::Isometry3d> poses = read_poses(call, files);
  std::vector<geometry::Scan> scans;
  std::vector<std::string> names;
  Json broken = Json::array();
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::optional<geometry::Scan> scan = read_scan(call, files[i], reasons);
    if (!scan) {
      broken.push_back(files[i].filename().string());
      continue;
    }
    scans.push_back(std::move(*scan));
    scans.back().T_object_scan = poses[i];
    scans.back().name = files[i].string();
    names.push_back(scans.back().name);
  }
  if (scans.empty()) throw FileError(reasons.front());
  Json registered = Json::array();
  if (call.registration.wanted)
    registered = register_named_scans(scans, names, "scan", call.registration);
  geometry::MergeScansOptions options = call.options;
  options.progress = shown_as("fusing");
  const geometry::MergedScans merged = geometry::merge_scans(scans, options);
  const Json conflicts = refuse_conflicts(call, merged, names);
  geometry::write_mesh_file(call.output, mesh_file(merged));
  if (!call.picture.empty()) {
    pictures::draw_mesh(call.picture, merged.mesh, "fused from " + counted(scans.size(), "scan"),
                        pictures::MeshPart::whole);
  }
  const int components = geometry::connected_components(merged.mesh).count;
  Json figures = {{"scans", scans.size()},
                  {"broken", broken},
                  {"spacing", merged.spacing},
                  {"vertices", merged.mesh.vertices.cols()},
                  {"triangles", merged.mesh.triangles.cols()},
                  {"components", components},
                  {"conflicts", conflicts}};
  std::string prose;
  if (merged.sigma.size() > 0) {
    const double sigma = median(merged.sigma);
    figures["median_sigma"] = sigma;
    prose = fmt::format(
        "the noise of the scans leaves a standard deviation of {:.4f} mm (median)\n", sigma);
  }
  figures["registered"] = registered;
  figures["file"] = call.output.string();
  print(settings, figures,
        prose + fmt::format("{} fused on a grid of {:.4g} mm into {} vertices and {} "
                            "triangles in {}, written to {}",
                            counted(scans.size(), "scan"), merged.spacing,
                            merged.mesh.vertices.cols(), merged.mesh.triangles.cols(),
                            counted(components, "piece"), call.output.string()));
  if (!broken.empty()) {
    throw Error(fmt::format("{} of {} scans could not be read; the others were fused.",
                            broken.size(), files.size()));
  }
}

}  // namespace

void add_fuse(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<FuseCall>();
  CLI::App* command =
      app.add_subcommand("fuse", "Fuse range maps or meshes of an object into one surface");
  add_required(*command, "SCAN", call->inputs,
               "Range maps (TIFF), depth images (16-bit PNG) or folders of them; or mesh files");
  add_required(*command, "-o,--output", call->output, "Mesh to write (.ply, .obj or .stl)");
  command->add_option(
      "--pose", call->poses,
      "Poses of the scans in one coordinate system: text files with a 4 x 4 matrix (rotation "
      "and translation [mm]) that maps the scan into it, one per scan in the same order, or a "
      "folder that has NAME.txt for the scan NAME (default: all scans already are in one)");
  add_scan_registration(*command, "scan", call->registration);
  add_camera_options(*command, call->camera);
  add_selection_options(*command, call->camera);
  add_unit_option(*command, call->meshes);
  add_fields(*command, fields_of(call->options));
  command->add_flag("--force", call->force,
                    "Fuse scans that disagree where they overlap, which is refused otherwise");
  command->add_option("--picture", call->picture, "Also draw the surface (PNG)");
  command->footer(
      "The signed distances of all scans are averaged on a grid, and the surface is where they are "
      "zero. It is open where no scan measured. All scans must show the object in one state: where "
      "one measured behind the surface of another, by more than the reach, they disagree (exit "
      "status 1). Range maps of a folder that cannot be read are named and left out (exit status "
      "1). If decode --sigma has written the standard deviations of all range maps beside them, "
      "the mean is weighted by them, and a PLY file gets the standard deviation of each vertex "
      "(sigma) that the noise of the scans leaves.\n"
      "Examples:\n  palpate fuse range/ -o still.ply                        # frames of a still "
      "scene\n"
      "  palpate fuse range/ --pose poses/ -o object.ply --spacing 0.5\n"
      "  palpate fuse front.ply left.ply back.ply --register --min-overlap 0.3 -o object.ply");
  command->callback([call, &settings] { fuse(settings, *call); });
}

}  // namespace palpate::apps
