// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "export/animation_file.h"
#include "export/depth_files.h"
#include "export/export_page.h"
#include "export/material_file.h"
#include "export/surface_file.h"
#include "palpate/core/error.h"
#include "palpate/haptics/model_io.h"
#include "shared/aliases.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

/// More frames than any folder holds.
constexpr int kMostEvery = 1'000'000;

struct ExportCall {
  PageCall page;  ///< its input and output are those of all formats
  SurfaceOptions surface;
  DepthFormats depths;
  bool ply = false, obj = false, vtk = false, glb = false, json = false, cbor = false, html = false;
  std::string material;        ///< a simulator
  std::optional<double> rate;  ///< [Hz] of an animation
};

/// A format of a file by its ending.
struct Format {
  std::string ending;
  enum class Kind { surface, depths, document, page } kind;
};
using Kind = Format::Kind;

std::vector<Format> formats_of(const ExportCall& call) {
  const std::array<std::pair<bool, Format>, 9> all{{{call.ply, {".ply", Kind::surface}},
                                                    {call.obj, {".obj", Kind::surface}},
                                                    {call.vtk, {".vtk", Kind::surface}},
                                                    {call.glb, {".glb", Kind::surface}},
                                                    {call.depths.png, {".png", Kind::depths}},
                                                    {call.depths.npy, {".npy", Kind::depths}},
                                                    {call.json, {".json", Kind::document}},
                                                    {call.cbor, {".cbor", Kind::document}},
                                                    {call.html, {".html", Kind::page}}}};
  std::vector<Format> wanted;
  for (const auto& [is_wanted, format] : all)
    if (is_wanted) wanted.push_back(format);
  return wanted;
}

bool has(std::span<const Format> formats, Kind kind) {
  return std::ranges::any_of(formats, [&](const Format& format) { return format.kind == kind; });
}

/// Returns true if the call writes all meshes of a folder.
bool is_animation(const ExportCall& call, PageContent content) {
  return call.glb && content == PageContent::meshes && is_folder(call.page.input);
}

/// Returns true if the call writes the depths of a folder, into one.
bool is_depth_folder(const ExportCall& call, PageContent content) {
  return (call.depths.png || call.depths.npy) && content == PageContent::range_maps &&
         is_folder(call.page.input);
}

void check_input(const ExportCall& call, PageContent content, std::span<const Format> formats) {
  const std::string input = call.page.input.string();
  if (has(formats, Kind::document) && content != PageContent::model)
    throw InvalidInput(input + ": is not a model; --json and --cbor write the fields of one.");
  if (has(formats, Kind::depths) && content != PageContent::range_maps) {
    throw InvalidInput(input +
                       ": is no range map and no depth image; --png and --npy write their depths.");
  }
  const auto surfaces = std::ranges::count(formats, Kind::surface, &Format::kind);
  const bool is_several = content != PageContent::model && is_folder(call.page.input);
  if (is_several && surfaces > (is_animation(call, content) ? 1 : 0)) {
    throw InvalidInput(input +
                       ": is a folder of several; give one of its files. --glb makes an animation "
                       "of meshes with the same triangles, as palpate track writes them.");
  }
}

void check_options(const ExportCall& call, PageContent content, std::span<const Format> formats) {
  check_page_options(call.page, content, has(formats, Kind::page),
                     is_animation(call, content) || is_depth_folder(call, content));
  if (call.surface.color && content != PageContent::range_maps) {
    throw InvalidInput(call.page.input.string() +
                       ": --color works for range maps; meshes keep the colours that they have.");
  }
  if (call.surface.color && !has(formats, Kind::surface))
    throw InvalidInput("--color: is for surfaces (--ply, --obj, --vtk or --glb).");
  if (call.rate && !is_animation(call, content))
    throw InvalidInput("--rate: is for a folder of meshes that becomes an animation (--glb).");
  if (call.depths.unit && !call.depths.png)
    throw InvalidInput("--depth-unit: is for depth images (--png).");
  if (call.depths.undistort && !has(formats, Kind::depths))
    throw InvalidInput("--undistort: is for depths (--png or --npy).");
  const bool has_presses = content == PageContent::model && (call.ply || call.vtk);
  if (call.surface.press_depth && !has_presses)
    throw InvalidInput("--press-depth: is for the surface of a model as --ply or --vtk.");
}

void check_takes_points(const ExportCall& call, const ExportedSurface& surface) {
  if (!surface.points || !(call.obj || call.vtk || call.glb)) return;
  throw InvalidInput(call.page.input.string() +
                     ": has points without a surface, which are written as --ply; a mesh is needed "
                     "for --obj, --vtk and --glb.");
}

void check_ending(const fs::path& output, const std::string& ending) {
  if (output.extension() == ending) return;
  throw InvalidInput(output.string() + ": the output file of this format must end in " + ending +
                     ".");
}

/// The name without ending of all files, or of the folder of depths.
fs::path name_of(const ExportCall& call, PageContent content, std::span<const Format> formats) {
  const bool to_folder = is_depth_folder(call, content);
  const fs::path& output = call.page.output;
  if (output.empty()) return to_folder ? "depth" : usual_name(content);
  fs::path without = fs::path(output).replace_extension();
  if (formats.size() == 1 && !to_folder) {
    check_ending(output, formats.front().ending);
    return without;
  }
  const auto named = std::ranges::find(formats, output.extension().string(), &Format::ending);
  if (formats.size() == 1 || named == formats.end()) return output;
  throw InvalidInput(output.string() +
                     ": each of the formats adds its ending to this name; choose one without, such "
                     "as " +
                     without.string() + ".");
}

/// The files that a call wrote, and a line about each.
struct Written {
  std::vector<fs::path> files;
  std::vector<std::string> lines;

  void add(const fs::path& file, const std::string& words) {
    files.push_back(file);
    lines.push_back("Written to " + file.string() + (words.empty() ? "" : ": " + words));
  }
};

/// Writes the depths in all their formats.
void write_all_depths(const ExportCall& call, PageContent content, const fs::path& name,
                      Written& written) {
  const PageCall& page = call.page;
  if (is_depth_folder(call, content)) {
    const std::string words =
        write_depth_folder(frames_of(page, content), page.camera, call.depths, name);
    return written.add(name, words);
  }
  std::string words = write_depths(page.input, page.camera, call.depths, name);
  if (call.depths.png) written.add(fs::path(name) += ".png", std::exchange(words, ""));
  if (call.depths.npy) written.add(fs::path(name) += ".npy", words);
}

Written write_all(const ExportCall& call, PageContent content, std::span<const Format> formats,
                  const fs::path& name) {
  Written written;
  if (has(formats, Kind::depths)) write_all_depths(call, content, name, written);
  std::optional<ExportedSurface> surface;
  for (const Format& format : formats) {
    const fs::path file = fs::path(name) += format.ending;
    switch (format.kind) {
      case Kind::surface:
        if (is_animation(call, content)) {
          written.add(file, write_animation(call.page, file, call.rate));
          break;
        }
        if (!surface) {
          surface = surface_of(call.page, content, call.surface, call.ply || call.vtk, file);
          check_takes_points(call, *surface);
        }
        written.add(file, write_surface(file, *surface));
        break;
      case Kind::document:
        haptics::write_field_document(
            file, haptics::read_model(call.page.input),
            format.ending == ".json" ? haptics::ModelEncoding::json : haptics::ModelEncoding::cbor);
        written.add(file, "");
        break;
      case Kind::page:
        written.add(file, export_page(call.page, content, file));
        break;
      case Kind::depths:
        break;  // written together
    }
  }
  return written;
}

void export_material(const Settings& settings, ExportCall call) {
  if (!formats_of(call).empty()) {
    throw InvalidInput(
        "--material: writes a solid, of which there are no other formats; write those in another "
        "call.");
  }
  if (call.surface.color || call.surface.press_depth || call.page.every || call.rate ||
      call.depths.unit || call.depths.undistort || !call.page.title.empty()) {
    throw InvalidInput(
        "palpate export: --color, --press-depth, --depth-unit, --undistort, --every, --rate and "
        "--title are for surfaces, depths and pages; --material writes a solid");
  }
  const std::string ending = simulator_ending(call.material);
  fs::path& output = call.page.output;
  if (output.empty()) output = "solid" + ending;
  check_outputs({call.page.input}, {output});
  check_ending(output, ending);
  const std::string written = write_material(call.page.input, call.material, output);
  print(settings, {{"file", output.string()}}, "Written to " + output.string() + ": " + written);
}

void export_as(const Settings& settings, ExportCall call) {
  if (!call.material.empty()) return export_material(settings, std::move(call));
  const std::vector<Format> formats = formats_of(call);
  const PageContent content = content_of(call.page.input);
  const fs::path name = name_of(call, content, formats);
  std::vector<fs::path> files;
  for (const Format& format : formats) {
    if (format.kind != Kind::depths || !is_depth_folder(call, content))
      files.push_back(fs::path(name) += format.ending);
  }
  if (is_depth_folder(call, content)) files.push_back(name);
  check_outputs({call.page.input}, files);
  check_input(call, content, formats);
  check_options(call, content, formats);
  const Written written = write_all(call, content, formats, name);
  print(settings, {{"file", written.files.front().string()}},
        fmt::format("{}", fmt::join(written.lines, "\n")));
}

}  // namespace

void add_export(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ExportCall>();
  PageCall& page = call->page;
  CLI::App* command = app.add_subcommand(
      "export",
      "Export a model, a mesh, a range map or a solid for other programs, or as a web page");
  add_required(*command, "INPUT", page.input,
               "Model folder, range map, depth image or mesh, with --ply also points; with --html "
               "also a folder of "
               "range maps, depth images or meshes; with --png and --npy also a folder of range "
               "maps or depth images; with --glb also a folder of meshes with the same triangles; "
               "with --material a specimen file");
  CLI::Option_group* format =
      command->add_option_group("format", "What to write: one format or several; --material alone");
  format->add_flag(
      "--ply", call->ply,
      "The surface (of a model: undeformed) as PLY, with the names by which CloudCompare and "
      "MeshLab show its values");
  format->add_flag("--obj", call->obj, "The surface as OBJ");
  format->add_flag("--vtk", call->vtk, "The surface as VTK, for ParaView");
  format->add_flag(
      "--glb", call->glb,
      "The surface as binary glTF, in metres, for game engines; of a folder of meshes, as "
      "palpate track writes them, one animated surface");
  format->add_flag("--png", call->depths.png,
                   "The depths of range maps as depth images for Open3D, tools of TUM RGB-D and "
                   "others: 16-bit PNG, 0 where unknown, with the camera beside them");
  format->add_flag("--npy", call->depths.npy,
                   "The depths as arrays for numpy, float32 in mm, NaN where unknown");
  format->add_flag("--json", call->json,
                   "Contacts, fields and friction of a model as one JSON document");
  format->add_flag("--cbor", call->cbor, "The same document in CBOR");
  format->add_flag(
      "--html", call->html,
      "A page, one file for any browser: a model to press and to drag on, range maps in "
      "false colour and in space, or meshes");
  add_word(*format, "--material", call->material, simulators(),
           "The solid of a specimen file, with its material, for a simulator: calculix, "
           "mujoco or sofa");
  format->require_option(1, 0);
  command->add_flag("--color", call->surface.color,
                    "Colour the surface of a range map by the picture that palpate decode "
                    "--surface-color has written beside it");
  add_number(
      *command, "--press-depth", call->surface.press_depth, above(0).finite(),
      "Surface of a model (--ply, --vtk): depth of the press whose force and stiffness are written "
      "at each vertex (default: the depth at which the model compares its contacts) [mm]");
  add_number(*command, "--depth-unit", call->depths.unit, above(0).finite(),
             fmt::format("Depth images (--png): length of one unit; depths are rounded to it "
                         "(default: {:g}). Many programs assume 1, tools of TUM RGB-D 0.2 [mm]",
                         kDepthUnit));
  command->add_flag(
      "--undistort", call->depths.undistort,
      "Depths (--png, --npy): convert them to a camera without lens distortion, for programs that "
      "do not support it");
  add_number(*command, "--unknown-friction", page.unknown_friction, at_least(0).finite(),
             "Coefficient of friction of contacts where the measurements do not tell it");
  add_camera_options(*command, page.camera);
  add_unit_option(*command, page.meshes);
  add_number(
      *command, "--every", page.every, at_least(1).at_most(kMostEvery),
      "Page or depths of a folder, or animation: take only every Nth frame, for sequences that are "
      "too long");
  add_number(*command, "--rate", call->rate, above(0).finite(),
             "Animation (--glb): frames per second; frames are numbered by their names "
             "(default: 5). Names that are times in seconds need none [Hz]");
  command->add_option("--title", page.title, "Title of the page (default: name of the input)");
  command->add_option(
      "-o,--output", page.output,
      "File to write (default: model, range, mesh or solid with the ending of the format); with "
      "several formats, the name without ending; for a folder of depths, the output folder "
      "(default: depth)");
  command->footer(
      "Here --json selects the format of the file; this command prints no JSON.\n"
      "A page of range maps also shows the predicted deviations and the reasons of lost pixels "
      "that palpate decode wrote\nbeside them (--sigma, --reasons). Depths and coordinates in "
      "pages are rounded; the command and the page say to what.\n"
      "Beside depths lies their camera: camera_intrinsic.json of Open3D, or camera.yaml if the "
      "lens "
      "distorts and\n--undistort is not given.\n"
      "Examples:\n  palpate export model/ --obj -o model.obj\n"
      "  palpate export model/ --obj --json -o model          # model.obj and model.json\n"
      "  palpate export model/ --vtk --press-depth 2 -o model.vtk\n"
      "  palpate export range/000000.tiff --png -o frame.png\n"
      "  palpate export range/ --png --undistort --depth-unit 1 -o depth/\n"
      "  palpate export surface.ply --glb -o surface.glb\n"
      "  palpate export range/000000.tiff --color --glb -o frame.glb\n"
      "  palpate export tracked/ --rate 30 --glb -o motion.glb\n"
      "  palpate export model/ --html -o model.html\n"
      "  palpate export range/ --html -o range.html\n"
      "  palpate export depth/ --html --scale 1 --intrinsics 600,600,320,240 --every 5 -o "
      "range.html\n"
      "  palpate export surface.ply --html -o surface.html\n"
      "  palpate export meshes/ --html -o track.html\n"
      "  palpate export identified.json --material calculix -o solid.inp");
  command->callback([call, &settings] { export_as(settings, *call); });
}

}  // namespace palpate::apps
