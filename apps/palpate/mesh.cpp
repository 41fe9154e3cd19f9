// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "command_line.h"
#include "inputs.h"
#include "palpate/error.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/smoothing.h"
#include "palpate/pictures/draw_mesh.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct MeshCall {
  fs::path input, output, rig, picture;
  double scale = 0;
  std::vector<double> intrinsics;
  geometry::ReadOptions meshes;
  bool repair = false;
  double fill_holes = 0;
  int smooth = 0;
  double tolerance = 0;
};

geometry::RangeMap load_map(const MeshCall& call) {
  if (is_range_map(call.input)) return load_range_map(call.input, call.rig);
  if (!(call.scale > 0)) {
    throw InvalidInput(call.input.string() +
                       ": a depth image needs --scale, the mm that one unit stands for (> 0).");
  }
  if (call.intrinsics.empty()) {
    throw InvalidInput(call.input.string() +
                       ": a depth image needs its camera: --intrinsics fx,fy,cx,cy [px].");
  }
  const cv::Mat image = sensing::read_frame(call.input);
  return sensing::read_depth_image(call.input, call.scale,
                                   {.width = image.cols,
                                    .height = image.rows,
                                    .fx = call.intrinsics[0],
                                    .fy = call.intrinsics[1],
                                    .cx = call.intrinsics[2],
                                    .cy = call.intrinsics[3]});
}

/// A mesh on its way from input to output, and what was done to it.
struct Work {
  geometry::TriangleMesh mesh;
  nlohmann::ordered_json figures;
  std::string prose;
};

Work load(const MeshCall& call) {
  if (!is_range_map(call.input) && !is_image(call.input)) {
    geometry::ReadOptions options = call.meshes;
    options.keep_defects = call.repair;
    return {geometry::read_mesh(call.input, options), {}, ""};
  }
  const geometry::RangeMap map = load_map(call);
  const auto known = (map.z == map.z).count();
  Work work = {geometry::mesh_range_map(map).mesh,
               {{"pixels", known}},
               fmt::format("{} pixels with a depth\n", known)};
  if (work.mesh.triangles.cols() == 0)
    throw InvalidInput(call.input.string() + ": no two neighbouring pixels have a depth.");
  return work;
}

void repair(Work& work) {
  geometry::RepairedMesh repaired = geometry::repair_mesh(work.mesh);
  work.mesh = std::move(repaired.mesh);
  work.figures["repair"] = {{"removed_triangles", repaired.removed_triangles},
                            {"flipped_edges", repaired.flipped_edges},
                            {"turned_triangles", repaired.turned_triangles},
                            {"welded_vertices", repaired.welded_vertices},
                            {"removed_vertices", repaired.removed_vertices},
                            {"cut_edges", repaired.cut_edges}};
  work.prose += fmt::format(
      "repaired: {} triangles removed, {} edges flipped, {} triangles turned, {} vertices welded "
      "and {} removed, {} edges cut\n",
      repaired.removed_triangles, repaired.flipped_edges, repaired.turned_triangles,
      repaired.welded_vertices, repaired.removed_vertices, repaired.cut_edges);
  for (const geometry::MeshDefect& defect : geometry::find_defects(work.mesh))
    work.prose += "  left: " + geometry::describe(defect) + "\n";
}

void fill_holes(Work& work, double max_diameter) {
  geometry::FilledMesh filled = geometry::fill_holes(work.mesh, {.max_diameter = max_diameter});
  work.mesh = std::move(filled.mesh);
  work.figures["holes"] = {{"filled", filled.filled}, {"left", filled.left}};
  work.prose += fmt::format("{} holes filled, {} border loops left\n", filled.filled, filled.left);
}

void decimate(Work& work, double tolerance) {
  geometry::Decimation decimated = geometry::decimate(work.mesh, {.tolerance = tolerance});
  work.figures["decimation"] = {{"tolerance", tolerance},
                                {"triangles_before", work.mesh.triangles.cols()},
                                {"triangles_after", decimated.mesh.triangles.cols()},
                                {"distance", decimated.distance}};
  work.prose += fmt::format(
      "{} triangles before, {} after; the Hausdorff distance is at most {:.4f} mm, verified\n",
      work.mesh.triangles.cols(), decimated.mesh.triangles.cols(), decimated.distance);
  work.mesh = std::move(decimated.mesh);
}

void mesh(const Settings& settings, const MeshCall& call) {
  check_outputs({call.input}, {call.output, call.picture});
  Work work = load(call);
  if (call.repair) repair(work);
  if (call.fill_holes > 0) fill_holes(work, call.fill_holes);
  if (call.smooth > 0) work.mesh = geometry::smooth(work.mesh, {.iterations = call.smooth});
  if (call.tolerance > 0) decimate(work, call.tolerance);
  geometry::write_mesh(call.output, work.mesh);
  if (!call.picture.empty())
    pictures::draw_mesh(call.picture, work.mesh, call.input.filename().string());
  work.figures["vertices"] = work.mesh.vertices.cols();
  work.figures["triangles"] = work.mesh.triangles.cols();
  work.figures["file"] = call.output.string();
  print(settings, work.figures,
        work.prose + fmt::format("{} vertices, {} triangles, written to {}",
                                 work.mesh.vertices.cols(), work.mesh.triangles.cols(),
                                 call.output.string()));
}

}  // namespace

void add_mesh(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MeshCall>();
  CLI::App* command = app.add_subcommand(
      "mesh", "A range map or a depth image becomes a mesh; a mesh is mended, smoothed, decimated");
  command
      ->add_option("RANGE", call->input,
                   "Range map (TIFF), depth image (16-bit PNG), or a mesh file (of which the "
                   "surface alone is kept)")
      ->required();
  command->add_option("-o,--output", call->output, "Mesh to write: .ply, .obj or .stl")->required();
  command->add_option("--rig", call->rig, "Rig of the range map (default: rig.yaml beside it)");
  command->add_option("--scale", call->scale, "Depth image: mm that one unit stands for");
  command
      ->add_option("--intrinsics", call->intrinsics, "Depth image: fx,fy,cx,cy of its camera [px]")
      ->expected(4)
      ->delimiter(',');
  add_unit_option(*command, call->meshes);
  command->add_flag("--repair", call->repair,
                    "Mend what palpate info lists: the result is manifold and oriented");
  command
      ->add_option("--fill-holes", call->fill_holes, "Fill holes that are at most so many mm wide")
      ->check(positive());
  command
      ->add_option("--smooth", call->smooth,
                   "Iterations of smoothing without shrinking (Taubin); 20 take most noise")
      ->check(not_negative());
  command
      ->add_option("--tolerance", call->tolerance,
                   "Take triangles away as long as the Hausdorff distance stays within so many mm")
      ->check(positive());
  command->add_option("--picture", call->picture, "Also draw the mesh (PNG)");
  command->footer(
      "What is asked for is done in the order repair, fill, smooth, decimate.\n\n"
      "Examples:\n  palpate mesh range/000000.tiff -o surface.ply --tolerance 0.2\n"
      "  palpate mesh broken.stl --repair --fill-holes 20 -o whole.ply\n"
      "  palpate mesh depth.png --scale 0.125 --intrinsics 476.007,476.007,313.683,242.755 -o "
      "hand.ply");
  command->callback([call, &settings] { mesh(settings, *call); });
}

}  // namespace palpate::apps
