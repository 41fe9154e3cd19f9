// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <regex>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "seeing/decode_input.h"
#include "seeing/simulate_report.h"
#include "seeing/simulate_shard.h"
#include "seeing/simulate_shots.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// Files in a folder of simulated frames.
const std::regex kOwnFiles(
    R"((rig|sensor)\.yaml|frames/\d{6,}(_\d\d)?\.png|truth/(rig\.yaml|\d{6,}(\.tiff|_lit\.png|_id\.png)))"
    R"(|training/\d{6,}/[^/]+_flat\.png|report/\d{6,}\.png|shards/[^/]+)");

/// [mm] Range of the distances of objects.
constexpr Interval kDistances = at_least(0.1).at_most(1e6);

/// Checks the options as far as possible before reading files.
void check_options(const SimulateCall& call) {
  if (call.scene.reflectance.size() == 2) {
    throw InvalidInput("--reflectance: 2 values; expected one, or three (red,green,blue)");
  }
  if (call.scene.shutter > 0 && call.scene.meshes.size() == 1) {
    throw InvalidInput(
        "--shutter: a single mesh is at rest and not blurred; pass several meshes of a motion");
  }
}

/// Entries of the output folder that may be replaced.
std::vector<fs::path> check_places(const SimulateCall& call) {
  std::vector<fs::path> inputs = call.scene.meshes;
  inputs.insert(inputs.end(),
                {call.rig, call.pattern, call.decoder_rig, call.sensor_file, call.scene.texture});
  check_output_folder(inputs, call.output);
  // The scene is examined before its frames are rendered.
  for (const fs::path& mesh : call.scene.meshes) refuse_pipes({{"MESH", mesh}});
  if (call.shard) return {};  // shards replace nothing, and others may be at work
  return own_entries(call.output, "sensor.yaml", kOwnFiles);
}

void simulate(const Settings& settings, const CLI::App& command, const SimulateCall& call) {
  check_options(call);
  const std::vector<fs::path> replaced = check_places(call);
  const SimulateSetup setup = read_setup(call);
  if (call.shard) return simulate_shard(settings, command, call, setup);
  std::vector<ReportLine> lines;
  write_folder(call.output, replaced, [&](const fs::path& output) {
    write_setup(setup, output);
    Progress progress("simulating");
    for (std::size_t i = 0; i < setup.shots.size(); ++i) {
      if (auto line = do_shot(call, setup, output, i).line) lines.push_back(std::move(*line));
      progress.show(i + 1, setup.shots.size());
    }
  });
  print_simulated(settings, lines, setup.shots.size(), setup.panels.size(), call.output);
}

void add_scene_options(CLI::App& command, SimulateCall& call) {
  SceneCall& scene = call.scene;
  command.option_defaults()->group("Scene");
  add_number(command, "--distance", call.distances, kDistances,
             "Depth [mm] of the mesh's centre, on the camera's axis; several depths (600,800) "
             "give one frame each. Default: the position in the file if it is in view, "
             "otherwise so that the mesh fills the image")
      ->delimiter(',');
  add_number(command, "--turn", scene.turn, at_least(-360).at_most(360),
             "x,y,z: rotation of the mesh about its centre, in degrees (-360 to 360) about "
             "each axis of the camera")
      ->expected(3)
      ->delimiter(',');
  add_number(command, "--wall", scene.wall, kDistances, "Add a white wall at this depth [mm]");
  command
      .add_option("--reflectance", scene.reflectance,
                  "Share of the light that the surface reflects: one number, or red,green,blue "
                  "(default: 0.8); multiplied with the colours of the mesh's vertices")
      ->delimiter(',')
      ->expected(1, 3);
  command.add_option(
      "--texture", scene.texture,
      "Image on the surface, linear in the light; the mesh needs texture coordinates "
      "(s, t)");
  command.add_option("--specular", scene.specular,
                     "Strength of the highlight, 0 to 1 (default: 0)");
  command.add_option("--shininess", scene.shininess,
                     "Exponent of the highlight, >= 1 (default: 50)");
  add_number(command, "--shutter", scene.shutter, at_least(0).at_most(1),
             "Share of the time between two meshes during which the shutter is open "
             "(default: 0, no motion blur). The last mesh has no next one, so it is not blurred");
}

void add_sensor_options(CLI::App& command, SimulateCall& call) {
  command.option_defaults()->group("Sensor");
  command.add_option("--sensor", call.sensor_file,
                     "Light, optics and electronics (sensor.yaml); default: a colour camera with 8 "
                     "bits. To change it, edit a copy of OUT/sensor.yaml, which lists all values");
  command.add_flag("--ideal", call.ideal, "No blur, no mosaic, no noise, 16 bits");
  call.sensor_options = add_fields(command, fields_of(call.sensor));
}

}  // namespace

void add_simulate(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<SimulateCall>();
  call->scene.reflectance = {0.8};
  CLI::App* command = app.add_subcommand(
      "simulate", "Render camera frames and true range maps from meshes, rig and pattern");
  add_required(*command, "MESH", call->scene.meshes,
               "A mesh, or a sequence of meshes, one per frame");
  add_required(*command, "--rig", call->rig, "Camera and projector (rig.yaml)");
  add_required(*command, "--pattern", call->pattern,
               "Projected pattern (pattern.yaml, with its image pattern.png, or its images "
               "shot_00.png, ... of a still scene, beside it)");
  add_required(*command, "-o,--output", call->output, "Folder to write");
  CLI::Option* report = command->add_flag(
      "--report", call->report,
      "Decode the frames and compare them with the truth: coverage, depth errors, "
      "causes of loss, and a picture of the errors");
  command->add_option("--decoder-rig", call->decoder_rig,
                      "Rig for decoding the frames, if the pattern was drawn to compensate the "
                      "projector's pose or chromatic aberration (default: --rig)");
  add_unit_option(*command, call->scene.read);
  const std::string usual = command->option_defaults()->get_group();
  add_scene_options(*command, *call);
  add_sensor_options(*command, *call);
  command->option_defaults()->group(usual);
  add_shard_option(*command, call->shard)->excludes(report);
  command->footer(
      "Writes frames/NNNNNN.png; truth/NNNNNN.tiff, _id.png (1: the mesh, 2: the wall) and "
      "_lit.png;\n"
      "training/NNNNNN/ with images of each colour alone, for palpate calibrate colors (of the "
      "first frame, with --report of all frames); rig.yaml and sensor.yaml. With a pattern for "
      "several images of a still scene\n"
      "(palpate pattern --multishot), frames/NNNNNN_00.png, ... in the order that palpate decode "
      "--multishot reads.\n\n"
      "Examples:\n"
      "  palpate simulate meshes/hand.ply --rig demo/rig.yaml --pattern demo/pattern.yaml --report "
      "-o out\n"
      "  palpate simulate part.stl --unit cm --rig rig.yaml --pattern pattern.yaml --turn 0,30,0 "
      "--distance 600,800,1000 --report -o out");
  command->callback([call, command, &settings] { simulate(settings, *command, *call); });
}

}  // namespace palpate::apps
