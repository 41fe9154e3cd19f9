// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "export/animation.h"
#include "export/export_page.h"
#include "export/material_files.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/haptics/model_io.h"
#include "shared/call_checks.h"
#include "shared/color_picture.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"
#include "surfaces/mesh_steps.h"

namespace palpate::apps {
namespace {

/// More frames than any folder holds.
constexpr int kMostEvery = 1'000'000;

struct ExportCall {
  PageCall page;       ///< its input and output are those of all formats
  bool color = false;  ///< of a range map
  bool ply = false, obj = false, vtk = false, glb = false, json = false, cbor = false, html = false;
  std::string material;        ///< a simulator
  std::optional<double> rate;  ///< [Hz] of an animation
};

std::string ending_of(const ExportCall& call) {
  if (call.ply) return ".ply";
  if (call.obj) return ".obj";
  if (call.vtk) return ".vtk";
  if (call.glb) return ".glb";
  if (call.json) return ".json";
  return call.cbor ? ".cbor" : ".html";
}

void check_output(const fs::path& input, const fs::path& output, const std::string& ending) {
  check_outputs({input}, {output});
  if (output.extension() == ending) return;
  throw InvalidInput(output.string() + ": the output file of this format must end in " + ending +
                     ".");
}

void write_document(const ExportCall& call, PageContent content) {
  if (content != PageContent::model) {
    throw InvalidInput(call.page.input.string() +
                       ": is not a model; --json and --cbor write the fields of one.");
  }
  haptics::write_field_document(
      call.page.output, haptics::read_model(call.page.input),
      call.json ? haptics::ModelEncoding::json : haptics::ModelEncoding::cbor);
}

geometry::MeshFile surface_of(const PageCall& call, PageContent content, bool color) {
  geometry::MeshFile file;
  if (content == PageContent::model) {
    file.mesh = haptics::read_model(call.input).surface;
  } else if (is_folder(call.input)) {
    throw InvalidInput(
        call.input.string() +
        ": is a folder of several; give one of its files. --glb makes an animation of "
        "meshes with the same triangles, as palpate track writes them.");
  } else if (content == PageContent::meshes) {
    file = geometry::read_mesh_file(call.input, call.meshes);
    file.material_files = seen_from(call.output, call.input, std::move(file.material_files));
  } else {
    file.mesh = geometry::mesh_range_map(load_range_map(call.input, call.camera)).mesh;
    if (color) file.vertex_attributes = colors_beside(call.input, file.mesh.vertices, call.camera);
  }
  return file;
}

/// \returns what was written, in words; empty unless it is an animation.
std::string write_without_page(const ExportCall& call, PageContent content) {
  const bool is_animation =
      call.glb && content == PageContent::meshes && is_folder(call.page.input);
  check_surface_options(call.page, content, is_animation);
  if (call.color && content != PageContent::range_maps) {
    throw InvalidInput(call.page.input.string() +
                       ": --color works for range maps; meshes keep the colours that they have.");
  }
  if (call.rate && !is_animation)
    throw InvalidInput("--rate: is for a folder of meshes that becomes an animation (--glb).");
  if (is_animation) {
    return write_animation({.folder = call.page.input,
                            .output = call.page.output,
                            .rate = call.rate,
                            .every = call.page.every.value_or(1),
                            .meshes = call.page.meshes});
  }
  if (call.json || call.cbor) {
    write_document(call, content);
  } else {
    geometry::write_mesh_file(call.page.output, surface_of(call.page, content, call.color));
  }
  return {};
}

void export_material(const Settings& settings, ExportCall call) {
  if (call.color || call.page.every || call.rate || !call.page.title.empty())
    throw InvalidInput(
        "palpate export: --color, --every, --rate and --title are for surfaces and pages; "
        "--material writes a solid");
  const std::string ending = simulator_ending(call.material);
  fs::path& output = call.page.output;
  if (output.empty()) output = "solid" + ending;
  check_output(call.page.input, output, ending);
  const std::string written = write_material(call.page.input, call.material, output);
  print(settings, {{"file", output.string()}}, "Written to " + output.string() + ": " + written);
}

void export_as(const Settings& settings, ExportCall call) {
  if (!call.material.empty()) return export_material(settings, std::move(call));
  const std::string ending = ending_of(call);
  fs::path& output = call.page.output;
  const PageContent content = content_of(call.page.input);
  if (output.empty()) output = usual_name(content).replace_extension(ending);
  check_output(call.page.input, output, ending);
  std::string written;
  if (call.html) {
    written = export_page(call.page, content);
  } else {
    written = write_without_page(call, content);
  }
  print(settings, {{"file", output.string()}},
        "Written to " + output.string() + (written.empty() ? "" : ": " + written));
}

}  // namespace

void add_export(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ExportCall>();
  PageCall& page = call->page;
  CLI::App* command = app.add_subcommand(
      "export",
      "Export a model, a mesh, a range map or a solid for other programs, or as a web page");
  command
      ->add_option(
          "INPUT", page.input,
          "Model folder, range map, depth image or mesh; with --html also a folder of "
          "range maps, depth images or meshes; with --glb also a folder of meshes with the "
          "same triangles; with --material a specimen file")
      ->required();
  CLI::Option_group* format = command->add_option_group("format", "What to write");
  format->add_flag("--ply", call->ply, "The surface (of a model: undeformed) as PLY");
  format->add_flag("--obj", call->obj, "The surface as OBJ");
  format->add_flag("--vtk", call->vtk, "The surface as VTK, for ParaView");
  format->add_flag(
      "--glb", call->glb,
      "The surface as binary glTF, in metres, for engines; of a folder of meshes, as palpate "
      "track writes them, one animated surface");
  format->add_flag("--json", call->json,
                   "Contacts, fields and friction of a model as one JSON document");
  format->add_flag("--cbor", call->cbor, "The same document in CBOR");
  format->add_flag(
      "--html", call->html,
      "A page, one file for any browser: a model to press and to drag on, range maps in "
      "false colour and in space, or meshes");
  format
      ->add_option("--material", call->material,
                   "The solid of a specimen file, with its material, for a simulator: calculix, "
                   "mujoco or sofa")
      ->check(one_of(simulators()));
  format->require_option(1);
  command
      ->add_flag("--color", call->color,
                 "Colour the surface of a range map by the picture that palpate decode "
                 "--surface-color has written beside it")
      ->excludes("--html");
  command
      ->add_option("--unknown-friction", page.unknown_friction,
                   "Coefficient of friction of contacts where the measurements do not tell it")
      ->check(within(at_least(0).finite()));
  add_camera_options(*command, page.camera);
  add_unit_option(*command, page.meshes);
  command
      ->add_option(
          "--every", page.every,
          "Page of a folder of range maps or meshes, or animation: take only every Nth frame, for "
          "sequences that are too long")
      ->check(within(at_least(1).at_most(kMostEvery)));
  command
      ->add_option("--rate", call->rate,
                   "Animation (--glb): frames per second; frames are numbered by their names "
                   "(default: 5). Names that are times in seconds need none [Hz]")
      ->check(within(above(0).finite()))
      ->excludes("--html");
  command->add_option("--title", page.title, "Title of the page (default: name of the input)");
  command->add_option(
      "-o,--output", page.output,
      "File to write (default: model, range, mesh or solid with the ending of the format)");
  command->footer(
      "Here --json selects the format of the file; this command prints no JSON.\n"
      "A page of range maps also shows the predicted deviations and the reasons of lost pixels "
      "that palpate decode wrote\nbeside them (--sigma, --reasons). Depths and coordinates in "
      "pages are rounded; the command and the page say to what.\n"
      "Examples:\n  palpate export model/ --obj -o model.obj\n"
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
