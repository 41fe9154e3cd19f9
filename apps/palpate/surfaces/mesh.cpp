// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/pictures/draw_mesh.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "surfaces/mesh_sequence.h"
#include "surfaces/mesh_steps.h"

namespace palpate::apps {
namespace {

/// Makes the mesh. Shows a bar from the first step on that may take long.
MadeMesh make_with_bar(const MeshCall& call) {
  MeshSteps steps = call.steps;
  steps.repairing.progress = shown_as("repairing");
  steps.filling.progress = shown_as("filling holes");
  steps.intersections.progress = shown_as("removing self-intersections");
  steps.remeshing.progress = shown_as("remeshing");
  steps.decimation.progress = shown_as("decimating");
  return make_mesh(call.inputs.front(), steps);
}

/// The options of a step that is done if the first of them is given; the others need that one.
void add_step(CLI::App& command, const FieldList& fields) {
  const std::vector<CLI::Option*> options = add_fields(command, fields);
  for (std::size_t i = 1; i < options.size(); ++i) options[i]->needs(options.front());
}

void mesh(const Settings& settings, const MeshCall& call) {
  check_color(call.steps, lower_extension(call.output));
  const fs::path& input = call.inputs.front();
  check_outputs({input}, {call.output, call.picture});
  check_pictures({call.picture});
  MadeMesh made = make_with_bar(call);
  write_made(made, input, call.output);
  if (!call.picture.empty())
    pictures::draw_mesh(call.picture, made.mesh, input.filename().string(),
                        is_image(input) ? pictures::MeshPart::object : pictures::MeshPart::whole);
  made.figures["file"] = call.output.string();
  print(settings, made.figures,
        made.prose + fmt::format("{} vertices, {} triangles, written to {}",
                                 made.mesh.vertices.cols(), made.mesh.triangles.cols(),
                                 call.output.string()));
}

}  // namespace

void add_mesh(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MeshCall>();
  CLI::App* command = app.add_subcommand(
      "mesh", "Mesh range maps or depth images; repair, smooth, remesh or decimate a mesh");
  add_required(*command, "RANGE", call->inputs,
               "Range map (TIFF) or depth image (16-bit PNG), several or a folder of one of "
               "these, or a mesh file. Colours and other values of its vertices are carried "
               "along, and its texture through all steps but --remesh");
  add_required(
      *command, "-o,--output", call->output,
      "Mesh to write (.ply, .obj or .stl); for several range maps or a folder: folder for the "
      "meshes");
  CLI::Option* format = add_word(*command, "--format", call->format, {"ply", "obj", "stl"},
                                 "Format of a folder's meshes: ply, obj or stl")
                            ->capture_default_str();
  add_camera_options(*command, call->steps.camera);
  add_selection_options(*command, call->steps.camera);
  add_fields(*command, fields_of(call->steps.meshing));
  add_unit_option(*command, call->steps.meshes);
  CLI::Option* smooth_depths = command->add_flag(
      "--smooth-depths", call->steps.smooth_depths,
      "Reduce the noise of depths before meshing; no depth moves by more than its standard "
      "deviation, as decode --sigma predicts it for a range map, or from --still");
  add_fields_of(*smooth_depths, *command, fields_of(call->steps.depth_smoothing));
  command
      ->add_option(
          "--still", call->still,
          "Depth images or range maps of a scene that does not move, by the same camera: "
          "a folder, or at least four files. The first 100 show the noise for --smooth-depths")
      ->needs(smooth_depths);
  CLI::Option* color =
      command->add_flag("--color", call->steps.color,
                        "Colour the vertices (ply, obj) as the surface is in the picture that "
                        "decode --surface-color has written beside the range map");
  command
      ->add_option("--color-images", call->steps.color_images,
                   "The same with the pictures of a folder that are aligned with the depths: "
                   "NAME.png, .jpg or .tiff for each range map or depth image NAME")
      ->excludes(color);
  command->add_flag(
      "--repair", call->steps.repair,
      "Repair the defects that palpate info lists; the result is manifold and oriented");
  add_fields(*command, fields_of(call->steps.filling));
  add_step(*command, fields_of(call->steps.smoothing));
  command->add_flag(
      "--remove-intersections", call->steps.remove_intersections,
      "Mend where neighbouring parts of the surface pass through each other, as noise, "
      "spikes and folds leave them; where distant parts do, they stay, and are counted");
  add_step(*command, fields_of(call->steps.remeshing));
  add_fields(*command, fields_of(call->steps.decimation));
  command->add_option("--picture", call->picture, "Also draw the mesh (PNG)");
  add_shard_option(*command, call->shard);
  command->footer(
      "The steps are done in this order: select depths, smooth depths, repair, fill holes, smooth, "
      "remove intersections, remesh, decimate.\n"
      "Several range maps or depth images, or a folder of them, give a sequence of meshes with the "
      "same names; one that cannot be meshed is reported and skipped, and the exit status is 1. "
      "Meshes of an earlier run are replaced as a whole when all are done.\n\n"
      "Examples:\n  palpate mesh range/000000.tiff -o surface.ply --tolerance 0.2\n"
      "  palpate mesh range/ -o meshes/ --format obj --fill-holes 10 --tolerance 0.2\n"
      "  palpate mesh broken.stl --repair --fill-holes 20 -o whole.ply\n"
      "  palpate mesh noisy.ply --repair --remove-intersections -o clean.ply\n"
      "  palpate mesh scan.ply --remesh 2 -o even.ply\n"
      "  palpate mesh depth.png --scale 0.125 --intrinsics 476.007,476.007,313.683,242.755 -o "
      "hand.ply\n"
      "  palpate mesh depth/ --scale 1 --camera camera.json --far 900 --remove-plane 5 -o meshes/");
  command->callback([call, command, format, &settings] {
    const fs::path& first = call->inputs.front();
    if (!call->still.empty()) call->steps.noise = noise_in(call->still, call->steps.camera);
    if (call->inputs.size() > 1 || is_folder(first)) {
      mesh_sequence(settings, *command, *call);
    } else if (format->count() > 0) {
      throw InvalidInput(
          "--format works for a sequence of range maps; the format of one mesh follows from its "
          "extension.");
    } else if (call->shard) {
      throw InvalidInput("--shard: works for a sequence of range maps, not for one mesh.");
    } else {
      mesh(settings, *call);
    }
  });
}

}  // namespace palpate::apps
