// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/require.h"
#include "palpate/core/work_in_order.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/pictures/draw_mesh.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/progress.h"
#include "shared/result_folder.h"
#include "surfaces/mesh_steps.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

/// Iterations of smoothing. A surface is smooth over its whole width long before.
constexpr int kMostSmoothing = 1000;

struct MeshCall {
  std::vector<fs::path> inputs;
  fs::path output, picture;
  std::string format = "ply";
  MeshSteps steps;
};

/// Shows a bar once one of the steps that may take long has begun.
MadeMesh make_with_bar(const MeshCall& call) {
  MeshSteps steps = call.steps;
  steps.repairing = shown_as("repairing");
  steps.filling = shown_as("filling holes");
  steps.removing_intersections = shown_as("removing self-intersections");
  steps.remeshing = shown_as("remeshing");
  steps.decimation.progress = shown_as("decimating");
  return make_mesh(call.inputs.front(), steps);
}

void write_made(const fs::path& output, const fs::path& input, const MadeMesh& made) {
  geometry::MeshFile file;
  file.mesh = made.mesh;
  file.vertex_attributes = made.attributes;
  if (made.texture) {
    const std::string extension = lower_extension(output);
    if (extension == ".ply" && !made.material_files.empty())
      spdlog::warn("{}: PLY has no materials, so those of {} are left out; write OBJ to keep them",
                   output.string(), made.material_files.front());
    if (extension != ".ply" && extension != ".obj")
      spdlog::warn("{}: the texture is left out; write OBJ or PLY to keep it", output.string());
    geometry::set_corner_texture(file.triangle_attributes, *made.texture);
    file.materials = made.materials;
    file.material_files = seen_from(output, input, made.material_files);
    file.comments = made.comments;
  }
  geometry::write_mesh_file(output, file);
}

/// \throws InvalidInput if colours are wanted in a format that has none.
void check_color(const MeshCall& call, const std::string& extension) {
  const bool has_images = !call.steps.color_images.empty();
  if ((call.steps.color || has_images) && extension == ".stl") {
    throw InvalidInput(std::string(has_images ? "--color-images" : "--color") +
                       ": STL has no colours; write PLY or OBJ.");
  }
}

void mesh(const Settings& settings, const MeshCall& call) {
  check_color(call, lower_extension(call.output));
  const fs::path& input = call.inputs.front();
  check_outputs({input}, {call.output, call.picture});
  check_pictures({call.picture});
  MadeMesh made = make_with_bar(call);
  write_made(call.output, input, made);
  if (!call.picture.empty())
    pictures::draw_mesh(call.picture, made.mesh, input.filename().string(),
                        is_image(input) ? pictures::MeshPart::object : pictures::MeshPart::whole);
  made.figures["file"] = call.output.string();
  print(settings, made.figures,
        made.prose + fmt::format("{} vertices, {} triangles, written to {}",
                                 made.mesh.vertices.cols(), made.mesh.triangles.cols(),
                                 call.output.string()));
}

/// A range map of a sequence, to be meshed.
struct SequenceItem {
  fs::path input, output;
  nlohmann::ordered_json figures;
  std::string error;  ///< empty if it worked
};

/// Rejects range maps whose meshes would have the same name.
void check_mesh_names(const std::vector<fs::path>& maps) {
  std::set<std::string> names;
  for (const fs::path& map : maps) {
    if (names.insert(map.stem().string()).second) continue;
    throw InvalidInput(map.string() + ": another range map is also called " + map.stem().string() +
                       ", and so would its mesh be. Rename one of them, or mesh them into two "
                       "folders.");
  }
}

/// Lists the meshes of the range maps that are there from an earlier run.
/// \throws InvalidInput if the folder holds meshes of another sequence.
std::vector<fs::path> earlier_meshes(const MeshCall& call, const std::vector<fs::path>& maps,
                                     const fs::path& folder) {
  std::set<std::string> ours;
  for (const fs::path& map : maps) ours.insert(map.stem().string());
  std::vector<fs::path> meshes;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& mesh = entry.path();
    if (mesh.extension() != "." + call.format || is_hidden(mesh)) continue;
    if (!ours.contains(mesh.stem().string())) {
      throw InvalidInput(mesh.string() +
                         ": is a mesh of no range map of this sequence, so two sequences would be "
                         "mixed. Pass a new or an empty folder, or remove this file.");
    }
    meshes.push_back(mesh.filename());
  }
  return meshes;
}

void make_one(const MeshCall& call, SequenceItem& item) {
  try {
    MadeMesh made = make_mesh(item.input, call.steps);
    write_made(item.output, item.input, made);
    item.figures = std::move(made.figures);
  } catch (const OutputError&) {
    throw;  // if there is no space for this file, there is none for the others
  } catch (const Error& error) {
    item.error = error.what();
  }
}

/// The name of the mesh of a range map.
fs::path mesh_name(const MeshCall& call, const fs::path& range_map) {
  return range_map.stem().string() + "." + call.format;
}

void mesh_sequence(const Settings& settings, const MeshCall& call) {
  if (!call.picture.empty())
    throw InvalidInput("--picture: works for one mesh, not for a sequence of range maps.");
  check_color(call, "." + call.format);
  check_outputs(call.inputs, {call.output});
  const MapCamera& camera = call.steps.camera;
  const std::vector<fs::path> maps = list_range_maps(call.inputs, camera);
  check_camera_options(maps.front(), camera);
  // One message about a camera that serves all.
  if (!camera.rig.empty()) (void)camera.files->cameras.read(camera.rig);
  check_mesh_names(maps);
  ResultFolder folder(
      call.output, [&](const fs::path& output) { return earlier_meshes(call, maps, output); },
      ResultFolder::Unfinished::dropped);
  folder.begin();
  const char* const kind = is_range_map(maps.front()) ? "range maps" : "depth images";
  nlohmann::ordered_json per_mesh = nlohmann::ordered_json::array();
  std::size_t broken = 0, begun = 0;
  std::string first_error, prose;
  Progress progress("meshing");
  const auto kept = [&] { return folder.what_is_kept(per_mesh.size() - broken, maps.size()); };
  const InterruptMessage message(kept());
  const auto next = [&]() -> std::optional<SequenceItem> {
    if (begun == maps.size()) return std::nullopt;
    const fs::path& map = maps[begun++];
    return SequenceItem{
        .input = map, .output = folder.place() / mesh_name(call, map), .figures = {}, .error = {}};
  };
  const auto deliver = [&](SequenceItem& item) {
    nlohmann::ordered_json entry = {{"range_map", item.input.filename().string()}};
    if (item.error.empty()) {
      const std::string file = (call.output / item.output.filename()).string();
      entry["file"] = file;
      entry.update(item.figures);
      prose += fmt::format("{} -> {}: {} triangles\n", item.input.filename().string(), file,
                           item.figures["triangles"].get<long>());
    } else {
      entry["error"] = item.error;
      spdlog::error("{}", item.error);
      if (broken++ == 0) first_error = item.error;
    }
    per_mesh.push_back(std::move(entry));
    InterruptMessage::set_kept(kept());
    progress.show(static_cast<int>(per_mesh.size()), static_cast<int>(maps.size()));
  };
  work_in_order<SequenceItem>(
      next, [&](SequenceItem& item) { make_one(call, item); }, deliver, usual_live_items());
  if (broken == maps.size()) throw FileError(first_error);
  folder.finish([](const fs::path&) { return true; });
  print(settings,
        {{"range_maps", maps.size()}, {"meshes", maps.size() - broken}, {"per_mesh", per_mesh}},
        prose + fmt::format("{} of {} {} were meshed, in {}", maps.size() - broken, maps.size(),
                            kind, call.output.string()));
  if (broken > 0) {
    throw Error(fmt::format("{} of {} {} could not be meshed; the others were.", broken,
                            maps.size(), kind));
  }
}

}  // namespace

void add_mesh(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MeshCall>();
  CLI::App* command = app.add_subcommand(
      "mesh", "Mesh range maps or depth images; repair, smooth, remesh or decimate a mesh");
  command
      ->add_option("RANGE", call->inputs,
                   "Range map (TIFF) or depth image (16-bit PNG), several or a folder of one of "
                   "these, or a mesh file. Colours and other values of its vertices are carried "
                   "along, and its texture through all steps but --remesh")
      ->required();
  command
      ->add_option(
          "-o,--output", call->output,
          "Mesh to write (.ply, .obj or .stl); for several range maps or a folder: folder for the "
          "meshes")
      ->required();
  CLI::Option* format =
      command->add_option("--format", call->format, "Format of a folder's meshes: ply, obj or stl")
          ->check(one_of({"ply", "obj", "stl"}))
          ->capture_default_str();
  add_camera_options(*command, call->steps.camera);
  add_selection_options(*command, call->steps.camera);
  add_unit_option(*command, call->steps.meshes);
  command->add_flag(
      "--smooth-depths", call->steps.smooth_depths,
      "Reduce the noise of the depths of a range map before meshing; no depth moves by "
      "more than its predicted deviation (from decode --sigma)");
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
  command->add_option("--fill-holes", call->steps.fill_holes, "Fill holes up to this diameter [mm]")
      ->check(within(above(0)));
  command
      ->add_option(
          "--smooth", call->steps.smooth,
          "Iterations of smoothing without shrinking (Taubin), at most 1000; 20 remove most "
          "noise")
      ->check(within(at_least(0).at_most(kMostSmoothing)));
  command->add_flag(
      "--remove-intersections", call->steps.remove_intersections,
      "Mend where neighbouring parts of the surface pass through each other, as noise, "
      "spikes and folds leave them; where distant parts do, they stay, and are counted");
  CLI::Option* remesh =
      command
          ->add_option("--remesh", call->steps.remesh,
                       "Make the triangles nearly equilateral, with edges of this length [mm]; the "
                       "border and sharp edges stay where they are")
          ->check(within(above(0).finite()));
  command
      ->add_option_function<double>(
          "--feature-angle",
          [call](double degrees) { call->steps.feature_angle = degrees * kDegree; },
          "With --remesh: edges at which the surface bends by more than this are sharp [degrees] "
          "(default: 60)")
      ->check(within(above(0).at_most(180)))
      ->needs(remesh);
  add_fields(*command, fields_of(call->steps.decimation));
  command->add_option("--picture", call->picture, "Also draw the mesh (PNG)");
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
  command->callback([call, format, &settings] {
    const fs::path& first = call->inputs.front();
    if (call->inputs.size() > 1 || is_folder(first)) {
      mesh_sequence(settings, *call);
    } else if (format->count() > 0) {
      throw InvalidInput(
          "--format works for a sequence of range maps; the format of one mesh follows from its "
          "extension.");
    } else {
      mesh(settings, *call);
    }
  });
}

}  // namespace palpate::apps
