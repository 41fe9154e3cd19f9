// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "calibrate.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

void calibrate_colors(const Settings& settings, const std::vector<fs::path>& folders,
                      const fs::path& output) {
  const sensing::TrainedColors trained = sensing::train_colors_from_folders(folders);
  sensing::write_trained_colors(output, trained);

  nlohmann::ordered_json figures = {{"colors", nlohmann::ordered_json::array()},
                                    {"file", output.string()}};
  std::string prose;
  for (const sensing::TrainedColor& color : trained.colors) {
    figures["colors"].push_back({{"name", color.name},
                                 {"mean", color.mean},
                                 {"variance", color.variance},
                                 {"pixels", color.pixels}});
    constexpr double kDegrees = 180 / std::numbers::pi;
    prose += fmt::format("{}: hue {:.1f} degrees, standard deviation {:.1f}, from {} pixels\n",
                         color.name, color.mean * kDegrees, std::sqrt(color.variance) * kDegrees,
                         color.pixels);
  }
  print(settings, figures, prose + "Written to " + output.string());
}

}  // namespace

void add_calibrate_colors(CLI::App& calibrate, const Settings& settings) {
  struct Call {
    std::vector<fs::path> folders;
    fs::path output;
  };
  auto call = std::make_shared<Call>();
  CLI::App* colors =
      calibrate.add_subcommand("colors", "Single-colour images become a hue classifier");
  colors
      ->add_option(
          "FOLDER", call->folders,
          "Folders of images R_flat.png, R_sin.png, ...: a scene lit with one pattern colour")
      ->required();
  colors->add_option("-o,--output", call->output, "Trained colours to write (colors.yaml)")
      ->required();
  colors->footer("Example:\n  palpate calibrate colors training/ -o colors.yaml");
  colors->callback([call, &settings] { calibrate_colors(settings, call->folders, call->output); });
}

}  // namespace palpate::apps
