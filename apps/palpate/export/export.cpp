// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "export/export_page.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/mesh_animation.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/material_text.h"
#include "palpate/probing/simulator_files.h"
#include "palpate/probing/specimen_file.h"
#include "shared/aliases.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "shared/surface_colors.h"
#include "surfaces/mesh_steps.h"
#include "surfaces/motion_sequence.h"
#include "surfaces/track_record.h"

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

/// [Hz] Pages begin to play at this rate too.
constexpr double kUsualRate = 5;

geometry::MeshAnimation read_animation(const std::vector<MotionFrame>& frames, double rate,
                                       const geometry::ReadOptions& options) {
  geometry::MeshAnimation animation;
  Progress progress("reading");
  for (const MotionFrame& frame : frames) {
    if (animation.times.empty()) {
      animation.first = geometry::read_mesh_file(frame.file, options);
    } else {
      const geometry::TriangleMesh& first = animation.first.mesh;
      const geometry::MeshFile mesh = read_motion_frame(frame.file, first, options);
      animation.displacements.emplace_back((mesh.mesh.vertices - first.vertices).cast<float>());
    }
    animation.times.push_back(frame.time / rate);
    progress.show(animation.times.size(), frames.size());
  }
  return animation;
}

std::string lost_in_words(const std::vector<std::string>& lost) {
  if (lost.empty()) return {};
  return fmt::format(
      ". {} of the sequence {} lost and left out ({}{}); the surface moves on between the frames "
      "beside them",
      lost.size() == 1 ? "1 frame" : fmt::format("{} frames", lost.size()),
      lost.size() == 1 ? "was" : "were", lost.front(), lost.size() == 1 ? "" : ", ...");
}

/// Writes meshes with the same triangles, as `track` writes them, as one animated surface.
/// \returns what was written, in words: frames, duration, size, and frames that `track` lost.
std::string write_animation(const ExportCall& call) {
  const PageCall& page = call.page;
  const MotionSequence sequence = motion_sequence(page.input);
  const std::optional<double> rate = frame_rate(sequence, call.rate);
  std::vector<MotionFrame> frames;
  for (std::size_t i = 0; i < sequence.frames.size();
       i += static_cast<std::size_t>(page.every.value_or(1)))
    frames.push_back(sequence.frames[i]);
  if (frames.size() < 2) {
    throw InvalidInput(
        fmt::format("{}: an animation takes at least two meshes; {}", page.input.string(),
                    sequence.frames.size() < 2
                        ? "the folder has one. Export " + frames.front().file.string() + " alone."
                        : fmt::format("--every takes one of {}", sequence.frames.size())));
  }
  const geometry::MeshAnimation animation =
      read_animation(frames, rate.value_or(kUsualRate), page.meshes);
  geometry::write_mesh_animation(page.output, animation);
  return fmt::format(
      "{} frames of {} vertices in {:.3g} s{}, {:.1f} MB{}", frames.size(),
      animation.first.mesh.vertices.cols(), animation.times.back(),
      rate ? "" : fmt::format(" ({:g} frames per second; --rate sets another rate)", kUsualRate),
      static_cast<double>(fs::file_size(page.output)) * 1e-6,
      lost_in_words(lost_frames(page.input)));
}

/// Simulators whose input `--material` writes.
std::vector<std::string> simulators() { return {"calculix", "mujoco", "sofa"}; }

std::string simulator_ending(const std::string& simulator) {
  if (simulator == "calculix") return ".inp";
  return simulator == "mujoco" ? ".xml" : ".scn";
}

/// Writes a solid with its material for a simulator, and the mesh that it loads beside it.
/// \return what was written, in words.
std::string write_material(const fs::path& input, const std::string& simulator,
                           const fs::path& output) {
  const std::string text = probing::read_specimen_text(input);
  const probing::FiniteElementObject object = probing::parse_finite_elements(text, input.string());
  fs::path mesh = output;
  mesh += ".msh";
  check_outputs({input, object.mesh_file}, {output, mesh});
  if (simulator == "calculix") {
    const std::vector<probing::KnownPress> presses = probing::parse_presses(text, input.string());
    std::optional<probing::KnownPress> press;
    if (!presses.empty()) press = presses.front();
    write_file(output, [&](std::ostream& out) { write_calculix(out, object, press); });
    if (!press)
      return "no press to compare with; palpate identify -o writes specimen files with some";
    return fmt::format("its last step is the press of contact {} with a measured force of {:.4g} N",
                       press->contact, press->force.norm());
  }
  const std::string mesh_name = mesh.filename().string();
  if (mesh_name.find_first_of("<&\"") != std::string::npos) {
    throw InvalidInput(output.string() +
                       ": the name of this file stands in XML; choose one without <, & and quotes");
  }
  constexpr double kMetre = 1e-3;  // of a millimetre
  const bool mujoco = simulator == "mujoco";
  write_file(output, [&](std::ostream& out) {
    if (mujoco) {
      write_mujoco(out, object, mesh_name);
    } else {
      write_sofa(out, object, mesh_name);
    }
  });
  write_file(mesh, [&](std::ostream& out) {
    write_linear_gmsh(out, object.body.mesh, mujoco ? kMetre : 1);
  });
  return "it loads " + mesh.string();
}

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
  if (is_animation) return write_animation(call);
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
  add_required(*command, "INPUT", page.input,
               "Model folder, range map, depth image or mesh; with --html also a folder of "
               "range maps, depth images or meshes; with --glb also a folder of meshes with the "
               "same triangles; with --material a specimen file");
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
  add_word(*format, "--material", call->material, simulators(),
           "The solid of a specimen file, with its material, for a simulator: calculix, "
           "mujoco or sofa");
  format->require_option(1);
  command
      ->add_flag("--color", call->color,
                 "Colour the surface of a range map by the picture that palpate decode "
                 "--surface-color has written beside it")
      ->excludes("--html");
  add_number(*command, "--unknown-friction", page.unknown_friction, at_least(0).finite(),
             "Coefficient of friction of contacts where the measurements do not tell it");
  add_camera_options(*command, page.camera);
  add_unit_option(*command, page.meshes);
  add_number(
      *command, "--every", page.every, at_least(1).at_most(kMostEvery),
      "Page of a folder of range maps or meshes, or animation: take only every Nth frame, for "
      "sequences that are too long");
  add_number(*command, "--rate", call->rate, above(0).finite(),
             "Animation (--glb): frames per second; frames are numbered by their names "
             "(default: 5). Names that are times in seconds need none [Hz]")
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
