// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "command_line.h"
#include "inputs.h"
#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/smoothing.h"
#include "palpate/pictures/draw_mesh.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct MeshCall {
  fs::path range, output, rig, picture;
  double scale = 0;
  int smooth = 0;
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

void mesh(const Settings& settings, const MeshCall& call) {
  check_outputs({call.range}, {call.output, call.picture});
  const geometry::RangeMap map = load(call);
  geometry::RangeMapMesh surface = geometry::mesh_range_map(map);
  if (surface.mesh.triangles.cols() == 0)
    throw InvalidInput(call.range.string() + ": no two neighbouring pixels have a depth.");
  if (call.smooth > 0) surface.mesh = geometry::smooth(surface.mesh, {.iterations = call.smooth});
  geometry::write_mesh(call.output, surface.mesh);
  if (!call.picture.empty())
    pictures::draw_mesh(call.picture, surface.mesh, call.range.filename().string());
  const auto known = (map.z == map.z).count();
  print(settings,
        {{"pixels", known},
         {"vertices", surface.mesh.vertices.cols()},
         {"triangles", surface.mesh.triangles.cols()},
         {"file", call.output.string()}},
        fmt::format("{} pixels with a depth -> {} vertices, {} triangles, written to {}", known,
                    surface.mesh.vertices.cols(), surface.mesh.triangles.cols(),
                    call.output.string()));
}

}  // namespace

void add_mesh(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MeshCall>();
  CLI::App* command = app.add_subcommand(
      "mesh", "A range map, or the depth image of another camera, becomes a mesh");
  command->add_option("RANGE", call->range, "Range map (TIFF), or depth image (16-bit PNG)")
      ->required();
  command->add_option("-o,--output", call->output, "Mesh to write: .ply, .obj or .stl")->required();
  command->add_option("--rig", call->rig, "Rig of the range map (default: rig.yaml beside it)");
  command->add_option("--scale", call->scale, "Depth image: mm that one unit stands for");
  command
      ->add_option("--intrinsics", call->intrinsics, "Depth image: fx,fy,cx,cy of its camera [px]")
      ->expected(4)
      ->delimiter(',');
  command
      ->add_option("--smooth", call->smooth,
                   "Iterations of smoothing without shrinking (Taubin); 20 take most noise")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--picture", call->picture, "Also draw the mesh (PNG)");
  command->footer(
      "Examples:\n  palpate mesh range/000000.tiff -o surface.ply\n"
      "  palpate mesh depth.png --scale 0.125 --intrinsics 476.007,476.007,313.683,242.755 -o "
      "hand.ply");
  command->callback([call, &settings] { mesh(settings, *call); });
}

}  // namespace palpate::apps
