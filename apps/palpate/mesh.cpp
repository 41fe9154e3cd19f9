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
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/pictures/draw_mesh.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct MeshCall {
  fs::path range, output, rig, picture;
  double scale = 0;
  double tolerance = 0;
  std::vector<double> intrinsics;
};

geometry::RangeMap load(const MeshCall& call) {
  if (is_range_map(call.range)) return load_range_map(call.range, call.rig);
  if (!(call.scale > 0)) {
    throw InvalidInput(call.range.string() +
                       ": a depth image needs --scale, the mm that one unit stands for (> 0).");
  }
  if (call.intrinsics.empty()) {
    throw InvalidInput(call.range.string() +
                       ": a depth image needs its camera: --intrinsics fx,fy,cx,cy [px].");
  }
  const cv::Mat image = sensing::read_frame(call.range);
  return sensing::read_depth_image(call.range, call.scale,
                                   {.width = image.cols,
                                    .height = image.rows,
                                    .fx = call.intrinsics[0],
                                    .fy = call.intrinsics[1],
                                    .cx = call.intrinsics[2],
                                    .cy = call.intrinsics[3]});
}

/// The surface, and how many pixels it comes from; none if it was a mesh already.
struct Surface {
  geometry::TriangleMesh mesh;
  std::optional<long> pixels;
};

Surface load_surface(const MeshCall& call) {
  if (!is_image(call.range)) return {.mesh = geometry::read_mesh(call.range), .pixels = {}};
  const geometry::RangeMap map = load(call);
  Surface surface{.mesh = geometry::mesh_range_map(map).mesh, .pixels = (map.z == map.z).count()};
  if (surface.mesh.triangles.cols() == 0)
    throw InvalidInput(call.range.string() + ": no two neighbouring pixels have a depth.");
  return surface;
}

/// Takes triangles away; what that did goes into the figures.
/// \return the same in words.
std::string decimate(const MeshCall& call, geometry::TriangleMesh& mesh,
                     nlohmann::ordered_json& figures) {
  const geometry::Decimation decimated = geometry::decimate(mesh, {.tolerance = call.tolerance});
  figures["decimation"] = {{"tolerance", call.tolerance},
                           {"triangles_before", mesh.triangles.cols()},
                           {"triangles_after", decimated.mesh.triangles.cols()},
                           {"distance", decimated.distance}};
  const std::string words = fmt::format(
      "{} triangles before, {} after; the Hausdorff distance is at most {:.4f} mm, verified\n",
      mesh.triangles.cols(), decimated.mesh.triangles.cols(), decimated.distance);
  mesh = decimated.mesh;
  return words;
}

void mesh(const Settings& settings, const MeshCall& call) {
  check_outputs({call.range}, {call.output, call.picture});
  Surface surface = load_surface(call);
  nlohmann::ordered_json figures;
  std::string prose;
  if (surface.pixels) {
    figures["pixels"] = *surface.pixels;
    prose = fmt::format("{} pixels with a depth\n", *surface.pixels);
  }
  if (call.tolerance != 0) prose += decimate(call, surface.mesh, figures);
  geometry::write_mesh(call.output, surface.mesh);
  if (!call.picture.empty())
    pictures::draw_mesh(call.picture, surface.mesh, call.range.filename().string());
  figures["vertices"] = surface.mesh.vertices.cols();
  figures["triangles"] = surface.mesh.triangles.cols();
  figures["file"] = call.output.string();
  print(
      settings, figures,
      prose + fmt::format("{} vertices, {} triangles, written to {}", surface.mesh.vertices.cols(),
                          surface.mesh.triangles.cols(), call.output.string()));
}

}  // namespace

void add_mesh(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MeshCall>();
  CLI::App* command = app.add_subcommand(
      "mesh", "A range map, or the depth image of another camera, becomes a mesh");
  command
      ->add_option("RANGE", call->range,
                   "Range map (TIFF), depth image (16-bit PNG), or a mesh file")
      ->required();
  command->add_option("-o,--output", call->output, "Mesh to write: .ply or .obj")->required();
  command->add_option("--rig", call->rig, "Rig of the range map (default: rig.yaml beside it)");
  command->add_option("--scale", call->scale, "Depth image: mm that one unit stands for");
  command
      ->add_option("--intrinsics", call->intrinsics, "Depth image: fx,fy,cx,cy of its camera [px]")
      ->expected(4)
      ->delimiter(',');
  command
      ->add_option("--tolerance", call->tolerance,
                   "Take triangles away as long as the Hausdorff distance stays within so many mm")
      ->check(CLI::PositiveNumber);
  command->add_option("--picture", call->picture, "Also draw the mesh (PNG)");
  command->footer(
      "Examples:\n  palpate mesh range/000000.tiff -o surface.ply --tolerance 0.2\n"
      "  palpate mesh surface.ply -o small.ply --tolerance 0.5\n"
      "  palpate mesh depth.png --scale 0.125 --intrinsics 476.007,476.007,313.683,242.755 -o "
      "hand.ply");
  command->callback([call, &settings] { mesh(settings, *call); });
}

}  // namespace palpate::apps
