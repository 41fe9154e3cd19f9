// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Costs and benefits of each choice in decoding, on simulated and on rendered frames: the figures
// of docs/trade-sensing.md.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <opencv2/core/utility.hpp>

#include "half_resolution.h"
#include "measure.h"
#include "palpate/core/output_file.h"
#include "picture.h"
#include "rendered_scenes.h"
#include "report.h"
#include "simulated_scenes.h"

namespace palpate::bench {
namespace {

namespace fs = std::filesystem;
using sensing::DecodeOptions;

struct Setting {
  std::string name;
  DecodeOptions options;
};

Experiment vary(const std::string& name, const std::vector<Scene>& scenes,
                const std::vector<Setting>& settings, int repeats) {
  Experiment experiment{name, {}};
  for (const Setting& setting : settings) {
    for (const Scene& scene : scenes) {
      experiment.rows.push_back(
          {setting.name, scene.name, measure(scene, setting.options, repeats)});
    }
  }
  return experiment;
}

/// At the whole resolution and at half of it.
Experiment vary_resolution(const std::vector<Scene>& scenes, int repeats) {
  Experiment experiment{"resolution", {}};
  const DecodeOptions options;
  for (const Scene& scene : scenes) {
    experiment.rows.push_back({"full", scene.name, measure(scene, options, repeats)});
  }
  for (const Scene& scene : scenes) {
    experiment.rows.push_back(
        {"half", scene.name, measure(half_resolution(scene), options, repeats)});
  }
  return experiment;
}

constexpr double kLengths[] = {1.25, 1.5, 2, 2.5, 3, 4, 6};  // periods

std::vector<Setting> windows(DecodeOptions options) {
  std::vector<Setting> settings;
  for (const double length : kLengths) {
    options.window_periods = length;
    settings.push_back({fmt::format("{} periods", length), options});
  }
  return settings;
}

std::vector<Setting> precisions() {
  std::vector<Setting> settings;
  for (const double sigma : {0.15, 0.25, 0.4}) {
    DecodeOptions options;
    options.max_phase_sigma = sigma;
    settings.push_back({fmt::format("{} rad", sigma), options});
  }
  return settings;
}

/// Each noise is an experiment of its own, with windows of all lengths.
Experiment vary_noise(const CameraNoise& noise, int repeats) {
  return vary(fmt::format("noise {} %", noise.percent), smooth_scenes(noise), windows({}), repeats);
}

/// One figure of one scene, or its median over all, against what is varied.
Curve curve_of(const std::string& name, const Experiment& experiment, const std::string& scene,
               double Figures::*figure) {
  Curve curve{name, {std::begin(kLengths), std::end(kLengths)}, {}};
  for (const Row& row : experiment.rows) {
    if (row.scene == scene) curve.y.push_back(row.figures.*figure);
  }
  return curve;
}

void draw(const fs::path& png, const std::vector<Experiment>& noises, const Experiment& snakes) {
  const std::string length = "window [periods]";
  const Experiment& usual = noises[1];
  Panel error{length, "median error [% of the distance]", {}};
  Panel coverage{length, "coverage [%]", {}, 100};
  for (const char* scene : {"planes", "folds", "hand", "print"}) {
    error.curves.push_back(curve_of(scene, usual, scene, &Figures::median));
    coverage.curves.push_back(curve_of(scene, usual, scene, &Figures::coverage));
  }
  Panel noise{length, "median error on planes [%]", {}};
  for (const Experiment& one : noises) {
    noise.curves.push_back(curve_of(one.name, one, "planes", &Figures::median));
  }
  Panel time{length, "ms a frame, hand", {}};
  time.curves = {curve_of("flood", usual, "hand", &Figures::ms),
                 curve_of("snakes", snakes, "hand", &Figures::ms)};
  draw_panels(png, "Accuracy, coverage and time by the length of the window",
              {error, coverage, noise, time});
}

/// The scenes with the default options alone.
void run_defaults(const std::vector<Scene>& scenes, int repeats) {
  write_scenes(std::cout, vary("smooth scenes", scenes, {{"default", {}}}, repeats));
  write_scenes(std::cout, vary("hard scenes", hard_scenes(), {{"default", {}}}, repeats));
  write_scenes(std::cout, vary("painted scenes", painted_scenes(), {{"default", {}}}, repeats));
}

void run(const fs::path& rendered, const fs::path& output, int repeats, bool defaults) {
  std::vector<Scene> scenes = smooth_scenes();
  if (!rendered.empty()) {
    for (Scene& scene : rendered_scenes(rendered)) scenes.push_back(std::move(scene));
  }
  if (defaults) return run_defaults(scenes, repeats);
  const DecodeOptions with_snakes{.segmentation = sensing::Segmentation::snakes};
  const std::vector<Setting> segmentations = {{"flood", {}}, {"snakes", with_snakes}};
  std::vector<Experiment> noises;
  for (const CameraNoise& noise : kCameraNoises) noises.push_back(vary_noise(noise, repeats));
  const Experiment snakes = vary("snakes", smooth_scenes(), windows(with_snakes), repeats);
  const std::vector<Scene> hard = hard_scenes();
  std::vector<Scene> every = scenes;
  every.insert(every.end(), hard.begin(), hard.end());
  std::vector<Experiment> all = {vary("window", scenes, windows({}), repeats),
                                 vary("max_phase_sigma", every, precisions(), repeats),
                                 vary("segmentation", scenes, segmentations, repeats),
                                 vary_resolution(scenes, repeats)};
  for (const Experiment& experiment : all) write_comparison(std::cout, experiment);
  for (const Experiment& experiment : noises) write_comparison(std::cout, experiment);
  all.insert(all.end(), noises.begin(), noises.end());
  all.push_back(snakes);
  for (const Setting& setting : segmentations) {
    all.push_back(vary("hard scenes, " + setting.name, hard, {setting}, repeats));
    write_scenes(std::cout, all.back());
  }
  all.push_back(vary("painted scenes", painted_scenes(), {{"default", {}}}, repeats));
  write_scenes(std::cout, all.back());
  write_file(output / "trade-sensing.csv", [&](std::ostream& out) { write_csv(out, all); });
  draw(output / "trade-sensing.png", noises, snakes);
}

}  // namespace
}  // namespace palpate::bench

int main(int count, char** arguments) try {
  CLI::App app("Measures what each choice in decoding costs and buys; prints Markdown");
  std::filesystem::path rendered, output = ".";
  int repeats = 5;
  app.add_option("--rendered", rendered, "Folder of rendered sets with their truth")
      ->check(CLI::ExistingDirectory);
  app.add_option("--repeats", repeats, "Decodings of a frame, the fastest of which counts")
      ->check(CLI::PositiveNumber);
  app.add_option("-o,--output", output, "Folder for trade-sensing.csv and trade-sensing.png");
  bool defaults = false;
  app.add_flag("--defaults", defaults, "Only a table of all scenes with the default options");
  CLI11_PARSE(app, count, arguments);
  // One thread, so that its processor time is that of the frame.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  palpate::bench::run(rendered, output, repeats, defaults);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
