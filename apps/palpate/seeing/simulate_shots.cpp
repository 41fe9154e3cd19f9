// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/simulate_shots.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/rig_assessment.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

sensing::VirtualSensor sensor_of(const SimulateCall& call) {
  sensing::VirtualSensor sensor;
  if (!call.sensor_file.empty()) sensor = sensing::read_virtual_sensor(call.sensor_file);
  if (call.ideal) sensor = sensing::ideal(sensor);
  sensing::VirtualSensor given = call.sensor;
  const std::vector<FieldText> values = texts_of(fields_of(given));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (call.sensor_options[i]->count() > 0)
      assign(fields_of(sensor), values[i].name, values[i].text);
  }
  return sensor;
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

using Bytes = Eigen::Array<unsigned char, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

void write_bytes(const fs::path& path, Bytes bytes) {
  sensing::write_png(path, cv::Mat(static_cast<int>(bytes.rows()), static_cast<int>(bytes.cols()),
                                   CV_8UC1, bytes.data()));
}

/// Writes the first `images` frames as those of the given number, their truth, and the training
/// images if there are any (their frames come after).
std::vector<fs::path> write_shot(const fs::path& output, std::size_t number, std::size_t images,
                                 const sensing::Simulation& simulation,
                                 const std::vector<sensing::NamedImages>& training) {
  const std::string name = fmt::format("{:06}", number);
  std::vector<fs::path> files;
  const auto next = [&](const fs::path& file) { return files.emplace_back(output / file); };
  for (std::size_t i = 0; i < images; ++i) {
    const std::string number_of_image = images > 1 ? fmt::format("_{:02}", i) : "";
    sensing::write_png(next(fmt::format("frames/{}{}.png", name, number_of_image)),
                       simulation.frames[i]);
  }
  geometry::write_depth_tiff(next("truth/" + name + ".tiff"), simulation.truth.range.z);
  write_bytes(next("truth/" + name + "_lit.png"), simulation.truth.lit.cast<unsigned char>() * 255);
  write_bytes(next("truth/" + name + "_id.png"), (simulation.truth.body + 1).cast<unsigned char>());
  for (const sensing::NamedImages& color : training)
    sensing::write_png(next("training/" + name + "/" + color.name + "_flat.png"), color.images[0]);
  return files;
}

/// Renders the frames of a shot, each shot with noise of its own; and decodes them for the report.
sensing::RigTrial render(const SimulateCall& call, const SimulateSetup& setup,
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

}  // namespace

std::vector<fs::path> panel_files(const SimulateCall& call, const sensing::Pattern& pattern) {
  if (!pattern.multishot) return {fs::path(call.pattern).replace_extension(".png")};
  const std::size_t count =
      pattern.multishot->shifts.size() + static_cast<std::size_t>(pattern.multishot->code_bits);
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < count; ++i)
    files.push_back(call.pattern.parent_path() / fmt::format("shot_{:02}.png", i));
  return files;
}

SimulateSetup read_setup(const SimulateCall& call) {
  SimulateSetup setup;
  setup.rig = load_rig(call.rig);
  setup.decoder_rig = call.decoder_rig.empty() ? setup.rig : load_rig(call.decoder_rig);
  setup.pattern = sensing::read_pattern(call.pattern);
  if (call.report && setup.pattern.multishot) {
    throw InvalidInput("--report: works for patterns of single images, and " +
                       call.pattern.string() +
                       " is for several images of a still scene; decode the frames with palpate "
                       "decode --multishot, and compare them with palpate compare");
  }
  for (const fs::path& image : panel_files(call, setup.pattern))
    setup.panels.push_back(read_panel(image, call.pattern, setup.rig.projector, call.rig));
  sensing::check_pattern_fits(setup.pattern, setup.decoder_rig.projector, call.pattern.string());
  setup.sensor = sensor_of(call);
  sensing::check_virtual_sensor(setup.sensor);
  setup.shots = shots_of(call);
  return setup;
}

void write_setup(const SimulateSetup& setup, const fs::path& output) {
  sensing::write_rig(output / "rig.yaml", setup.decoder_rig);
  sensing::write_rig(output / "truth" / "rig.yaml", setup.decoder_rig);
  sensing::write_virtual_sensor(output / "sensor.yaml", setup.sensor);
}

SimulatedShot do_shot(const SimulateCall& call, const SimulateSetup& setup, const fs::path& output,
                      std::size_t number) {
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
  SimulatedShot done{
      .files = write_shot(output, number, setup.panels.size(), trial.simulation, trial.training)};
  if (call.report)
    done.line = report_line(output / "report" / fmt::format("{:06}.png", number), trial);
  return done;
}

}  // namespace palpate::apps
