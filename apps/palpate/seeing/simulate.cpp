// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig_assessment.h"
#include "seeing/decode_input.h"
#include "seeing/simulate_report.h"
#include "seeing/simulate_scene.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Files in a folder of simulated frames.
const std::regex kOwnFiles(
    R"((rig|sensor)\.yaml|frames/\d{6,}(_\d\d)?\.png|truth/(rig\.yaml|\d{6,}(\.tiff|_lit\.png|_id\.png)))"
    R"(|training/\d{6,}/[^/]+_flat\.png|report/\d{6,}\.png)");

/// [mm] Range of the distances of objects.
constexpr Interval kDistances = at_least(0.1).at_most(1e6);
/// Largest ambient light; with more, every camera's noise hides the projector's light.
constexpr double kBrightest = 1e6;

struct SimulateCall {
  SceneCall scene;
  fs::path rig, pattern, decoder_rig, sensor, output;
  std::vector<double> distances;
  bool ideal = false, report = false;
  std::optional<double> ambient, exposure_distance;
  std::optional<int> bits;
  std::optional<int> seed;  ///< in the range of sensor.yaml
  std::string readout;
};

/// A frame: a mesh of the sequence at a distance.
struct Shot {
  std::size_t mesh = 0;
  std::optional<double> distance;
};

struct Setup {
  sensing::Rig rig, decoder_rig;
  sensing::Pattern pattern;
  std::vector<cv::Mat> panels;  ///< what the projector shows of each shot
  sensing::VirtualSensor sensor;
  std::vector<Shot> shots;
};

sensing::VirtualSensor sensor_of(const SimulateCall& call) {
  sensing::VirtualSensor sensor;
  if (!call.sensor.empty()) sensor = sensing::read_virtual_sensor(call.sensor);
  if (call.ideal) sensor = sensing::ideal(sensor);
  if (call.readout == "color") sensor.readout = sensing::Readout::color;
  if (call.readout == "mosaic") sensor.readout = sensing::Readout::mosaic;
  if (call.readout == "demosaiced") sensor.readout = sensing::Readout::demosaiced;
  sensor.bits = call.bits.value_or(sensor.bits);
  sensor.ambient = call.ambient.value_or(sensor.ambient);
  if (call.exposure_distance) sensor.exposure_distance = call.exposure_distance;
  if (call.seed) sensor.seed = static_cast<std::uint64_t>(*call.seed);
  return sensor;
}

/// The images beside the pattern file: one, or those of a still scene.
std::vector<cv::Mat> read_panels(const SimulateCall& call, const sensing::Pattern& pattern,
                                 const geometry::Camera& projector) {
  if (!pattern.multishot)
    return {read_panel(fs::path(call.pattern).replace_extension(".png"), call.pattern, projector,
                       call.rig)};
  const std::size_t count =
      pattern.multishot->shifts.size() + static_cast<std::size_t>(pattern.multishot->code_bits);
  std::vector<cv::Mat> panels;
  for (std::size_t i = 0; i < count; ++i) {
    const fs::path image = call.pattern.parent_path() / fmt::format("shot_{:02}.png", i);
    panels.push_back(read_panel(image, call.pattern, projector, call.rig));
  }
  return panels;
}

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

std::vector<Shot> shots_of(const SimulateCall& call) {
  std::vector<Shot> shots;
  if (call.scene.meshes.size() > 1) {
    if (call.distances.size() > 1) {
      throw InvalidInput(
          "--distance: several distances work only for one mesh; a sequence of meshes needs one");
    }
    for (std::size_t i = 0; i < call.scene.meshes.size(); ++i) {
      shots.push_back(
          {i, call.distances.empty() ? std::nullopt : std::optional(call.distances.front())});
    }
    return shots;
  }
  for (const double distance : call.distances) shots.push_back({0, distance});
  if (shots.empty()) shots.push_back({});
  return shots;
}

/// Entries of the output folder that may be replaced.
std::vector<fs::path> check_places(const SimulateCall& call) {
  std::vector<fs::path> inputs = call.scene.meshes;
  inputs.insert(inputs.end(),
                {call.rig, call.pattern, call.decoder_rig, call.sensor, call.scene.texture});
  check_output_folder(inputs, call.output);
  // The scene is looked at before its frames are rendered.
  for (const fs::path& mesh : call.scene.meshes) refuse_pipes({{"MESH", mesh}});
  return own_entries(call.output, "sensor.yaml", kOwnFiles);
}

Setup read_setup(const SimulateCall& call) {
  Setup setup;
  setup.rig = load_rig(call.rig);
  setup.decoder_rig = call.decoder_rig.empty() ? setup.rig : load_rig(call.decoder_rig);
  setup.pattern = sensing::read_pattern(call.pattern);
  if (call.report && setup.pattern.multishot) {
    throw InvalidInput("--report: works for patterns of single images, and " +
                       call.pattern.string() +
                       " is for several images of a still scene; decode the frames with palpate "
                       "decode --multishot, and compare them with palpate compare");
  }
  setup.panels = read_panels(call, setup.pattern, setup.rig.projector);
  sensing::check_pattern_fits(setup.pattern, setup.decoder_rig.projector, call.pattern.string());
  setup.sensor = sensor_of(call);
  sensing::check_virtual_sensor(setup.sensor, "the sensor");
  setup.shots = shots_of(call);
  return setup;
}

using Bytes = Eigen::Array<unsigned char, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

void write_bytes(const fs::path& path, Bytes bytes) {
  sensing::write_png(path, cv::Mat(static_cast<int>(bytes.rows()), static_cast<int>(bytes.cols()),
                                   CV_8UC1, bytes.data()));
}

/// Writes the first `images` frames as those of the given number, their truth, and the training
/// images if there are any (their frames come after).
void write_shot(const fs::path& output, std::size_t number, std::size_t images,
                const sensing::Simulation& simulation,
                const std::vector<sensing::NamedImages>& training) {
  const std::string name = fmt::format("{:06}", number);
  for (std::size_t i = 0; i < images; ++i) {
    sensing::write_png(
        output / "frames" / (images > 1 ? fmt::format("{}_{:02}.png", name, i) : name + ".png"),
        simulation.frames[i]);
  }
  const fs::path truth = output / "truth" / name;
  geometry::write_depth_tiff(truth.string() + ".tiff", simulation.truth.range.z);
  write_bytes(truth.string() + "_lit.png", simulation.truth.lit.cast<unsigned char>() * 255);
  write_bytes(truth.string() + "_id.png", (simulation.truth.body + 1).cast<unsigned char>());
  for (const sensing::NamedImages& color : training) {
    sensing::write_png(output / "training" / name / (color.name + "_flat.png"), color.images[0]);
  }
}

/// Renders the frames of a shot, each shot with noise of its own; and decodes them for the report.
sensing::RigTrial render(const SimulateCall& call, const Setup& setup,
                         const std::vector<sensing::Body>& bodies, std::size_t number) {
  if (setup.pattern.multishot) {
    sensing::RigTrial trial;
    trial.simulation = sensing::simulate(setup.rig, bodies, setup.panels, setup.sensor,
                                         setup.pattern.axis, number * setup.panels.size());
    return trial;
  }
  const std::uint64_t first_frame = number * (1 + setup.pattern.colors.size());
  const cv::Mat& panel = setup.panels.front();
  if (!call.report) {
    return sensing::simulate_shot(setup.rig, setup.pattern, panel, bodies, setup.sensor,
                                  {.training = number == 0, .first_frame = first_frame});
  }
  sensing::TrialOptions options;
  options.decoder_rig = setup.decoder_rig;
  options.first_frame = first_frame;
  return sensing::try_rig(setup.rig, setup.pattern, panel, bodies, setup.sensor, options);
}

/// Simulates one shot and writes the results; returns its line of the report if there is one.
std::optional<ReportLine> do_shot(const SimulateCall& call, const Setup& setup,
                                  const fs::path& output, std::size_t number) {
  const Shot& shot = setup.shots[number];
  const Placement placement = place_mesh(call.scene, setup.rig, shot.distance);
  const std::vector<sensing::Body> bodies =
      load_bodies(call.scene, setup.rig, placement, shot.mesh);
  if (placement.chosen && number == 0) {
    spdlog::warn(
        "{}: at its own position it is not completely in view, so it is moved to where it fills "
        "the image. Use --distance for another position.",
        call.scene.meshes.front().string());
  }
  const sensing::RigTrial trial = render(call, setup, bodies, number);
  if ((trial.simulation.truth.body != 0).all()) {
    throw InvalidInput(call.scene.meshes[shot.mesh].string() +
                       ": the camera sees nothing of it at this place; pass another --distance");
  }
  write_shot(output, number, setup.panels.size(), trial.simulation, trial.training);
  if (!call.report) return std::nullopt;
  return report_line(output / "report" / fmt::format("{:06}.png", number), trial);
}

void simulate(const Settings& settings, const SimulateCall& call) {
  check_options(call);
  const std::vector<fs::path> replaced = check_places(call);
  const Setup setup = read_setup(call);
  std::vector<ReportLine> lines;
  write_folder(call.output, replaced, [&](const fs::path& output) {
    sensing::write_rig(output / "rig.yaml", setup.decoder_rig);
    sensing::write_rig(output / "truth" / "rig.yaml", setup.decoder_rig);
    sensing::write_virtual_sensor(output / "sensor.yaml", setup.sensor);
    Progress progress("simulating");
    for (std::size_t i = 0; i < setup.shots.size(); ++i) {
      if (auto line = do_shot(call, setup, output, i)) lines.push_back(std::move(*line));
      progress.show(static_cast<int>(i + 1), static_cast<int>(setup.shots.size()));
    }
  });
  Json figures = {{"frames", setup.shots.size()}, {"folder", call.output.string()}};
  std::string prose = lines.empty() ? "" : report_table(lines);
  if (!lines.empty()) {
    figures["report"] = Json::array();
    for (const ReportLine& line : lines) figures["report"].push_back(report_figures(line));
  }
  if (setup.pattern.multishot) figures["images_of_each"] = setup.panels.size();
  prose += setup.pattern.multishot ? counted(setup.shots.size(), "scene") +
                                         fmt::format(" of {} images", setup.panels.size())
                                   : counted(setup.shots.size(), "frame");
  print(settings, figures,
        prose + " with their true range maps written to " + call.output.string());
}

void add_scene_options(CLI::App& command, SimulateCall& call) {
  SceneCall& scene = call.scene;
  const char* const group = "Scene";
  command
      .add_option("--distance", call.distances,
                  "Depth [mm] of the mesh's centre, on the camera's axis; several depths (600,800) "
                  "give one frame each. Default: the position in the file if it is in view, "
                  "otherwise so that the mesh fills the image")
      ->delimiter(',')
      ->check(within(kDistances))
      ->group(group);
  command
      .add_option("--turn", scene.turn,
                  "x,y,z: rotation of the mesh about its centre, in degrees (-360 to 360) about "
                  "each axis of the camera")
      ->expected(3)
      ->delimiter(',')
      ->check(within(at_least(-360).at_most(360)))
      ->group(group);
  command.add_option("--wall", scene.wall, "Add a white wall at this depth [mm]")
      ->check(within(kDistances))
      ->group(group);
  command
      .add_option("--reflectance", scene.reflectance,
                  "Share of the light that the surface reflects: one number, or red,green,blue "
                  "(default: 0.8); multiplied with the colours of the mesh's vertices")
      ->delimiter(',')
      ->expected(1, 3)
      ->group(group);
  command
      .add_option("--texture", scene.texture,
                  "Image on the surface, linear in the light; the mesh needs texture coordinates "
                  "(s, t)")
      ->group(group);
  command
      .add_option("--specular", scene.specular, "Strength of the highlight, 0 to 1 (default: 0)")
      ->group(group);
  command
      .add_option("--shininess", scene.shininess, "Exponent of the highlight, >= 1 (default: 50)")
      ->group(group);
  command
      .add_option(
          "--shutter", scene.shutter,
          "Share of the time between two meshes during which the shutter is open "
          "(default: 0, no motion blur). The last mesh has no next one, so it is not blurred")
      ->check(within(at_least(0).at_most(1)))
      ->group(group);
}

void add_sensor_options(CLI::App& command, SimulateCall& call) {
  const char* const group = "Sensor";
  command
      .add_option("--sensor", call.sensor,
                  "Light, optics and electronics (sensor.yaml); default: a colour camera with 8 "
                  "bits. To change it, edit a copy of OUT/sensor.yaml, which lists all values")
      ->group(group);
  command.add_flag("--ideal", call.ideal, "No blur, no mosaic, no noise, 16 bits")->group(group);
  command.add_option("--readout", call.readout, "Format of the camera's images")
      ->check(one_of({"color", "mosaic", "demosaiced"}))
      ->group(group);
  command.add_option("--bits", call.bits, "Bits per channel")
      ->check(one_of({"8", "16"}))
      ->group(group);
  command
      .add_option("--ambient", call.ambient,
                  "Ambient light, as a share of the projector's white on a surface 1 m away")
      ->check(within(at_least(0).at_most(kBrightest)))
      ->group(group);
  command
      .add_option(
          "--exposure", call.exposure_distance,
          "Expose for a white surface at this distance [mm], 0.1 to 1e6 (default: automatic "
          "exposure of each frame)")
      ->check(within(kDistances))
      ->group(group);
  command.add_option("--seed", call.seed, "Seed of the noise: 0 to 2147483647 (default: 1)")
      ->check(within(at_least(0)))
      ->group(group);
}

}  // namespace

void add_simulate(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<SimulateCall>();
  call->scene.reflectance = {0.8};
  CLI::App* command = app.add_subcommand(
      "simulate", "Render camera frames and true range maps from meshes, rig and pattern");
  command->add_option("MESH", call->scene.meshes, "A mesh, or a sequence of meshes, one per frame")
      ->required();
  command->add_option("--rig", call->rig, "Camera and projector (rig.yaml)")->required();
  command
      ->add_option("--pattern", call->pattern,
                   "Projected pattern (pattern.yaml, with its image pattern.png, or its images "
                   "shot_00.png, ... of a still scene, beside it)")
      ->required();
  command->add_option("-o,--output", call->output, "Folder to write")->required();
  command->add_flag("--report", call->report,
                    "Decode the frames and compare them with the truth: coverage, depth errors, "
                    "causes of loss, and a picture of the errors");
  command->add_option("--decoder-rig", call->decoder_rig,
                      "Rig for decoding the frames, if the pattern was drawn to compensate the "
                      "projector's pose or chromatic aberration (default: --rig)");
  add_unit_option(*command, call->scene.read);
  add_scene_options(*command, *call);
  add_sensor_options(*command, *call);
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
  command->callback([call, &settings] { simulate(settings, *call); });
}

}  // namespace palpate::apps
