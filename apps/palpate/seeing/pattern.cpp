// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/pattern_colors.h"
#include "palpate/sensing/pattern_design.h"
#include "palpate/sensing/pattern_image.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

/// If stripe edges tolerate less misplacement than this, they may identify the wrong period [camera
/// px].
constexpr double kLeastEdgeTolerance = 2;
/// Below this sensitivity most pixels cannot be reconstructed [rad].
constexpr double kLeastPhasePerDepth = 10;

/// Mean and amplitude of a sinusoid from black to white.
constexpr double kFullContrast = 0.5;

struct PatternCall {
  fs::path rig, colors, output;
  std::vector<int> size = {1024, 768};
  std::vector<double> distances;
  int grey_steps = 18;
  std::optional<int> multishot;  ///< number of steps
  sensing::PatternOptions design;
  sensing::DrawOptions drawing;
};

using NamedImage = std::pair<std::string, cv::Mat>;

/// Draws patterns, either for a rig or for a panel of which only the size is known.
struct Drawer {
  std::optional<sensing::Rig> rig;
  int width = 0;
  int height = 0;
  sensing::DrawOptions options;

  /// The panel in whose pixels the pattern is.
  [[nodiscard]] sensing::ImageSize panel() const {
    if (!rig) return {width, height};
    const geometry::Camera& projector = sensing::rig_of_drawing(*rig, options).projector;
    return {projector.width, projector.height};
  }
  [[nodiscard]] cv::Mat operator()(const sensing::Pattern& pattern) const {
    return rig ? sensing::draw_pattern(pattern, *rig, options)
               : sensing::draw_pattern(pattern, width, height, options.bits);
  }
  [[nodiscard]] std::vector<cv::Mat> multishot(const sensing::Pattern& pattern) const {
    return rig ? sensing::draw_multishot(pattern, *rig, options)
               : sensing::draw_multishot(pattern, width, height, options.bits);
  }
  [[nodiscard]] cv::Mat uniform(const Eigen::Vector3d& rgb) const {
    return sensing::draw_uniform(rgb, width, height, options.bits);
  }
};

/// The images of the pattern and for training.
std::vector<NamedImage> draw_all(const sensing::Pattern& pattern, const Drawer& draw,
                                 int grey_steps) {
  std::vector<NamedImage> images;
  if (pattern.multishot) {
    const std::vector<cv::Mat> shots = draw.multishot(pattern);
    for (std::size_t i = 0; i < shots.size(); ++i)
      images.emplace_back(fmt::format("shot_{:02}.png", i), shots[i]);
  } else {
    images.emplace_back("pattern.png", draw(pattern));
  }
  const double brightest = pattern.mean + pattern.amplitude;
  for (std::size_t i = 0; i < pattern.colors.size(); ++i) {
    const sensing::PatternColor& color = pattern.colors[i];
    images.emplace_back(color.name + "_flat.png", draw.uniform(brightest * color.rgb));
    images.emplace_back(color.name + "_sin.png",
                        draw(sensing::single_color(pattern, static_cast<int>(i))));
  }
  images.emplace_back("white_flat.png", draw.uniform(brightest * Eigen::Vector3d::Ones()));
  images.emplace_back("white_sin.png", draw(sensing::without_stripes(pattern)));
  images.emplace_back("projector_off.png", draw.uniform(Eigen::Vector3d::Zero()));
  for (const int level : sensing::grey_levels(grey_steps)) {
    images.emplace_back(fmt::format("grey_{:03}.png", level),
                        draw.uniform(level / 255.0 * Eigen::Vector3d::Ones()));
  }
  return images;
}

void write_all(const fs::path& output, const sensing::Pattern& pattern, const Drawer& draw,
               int grey_steps) {
  const std::vector<NamedImage> images = draw_all(pattern, draw, grey_steps);
  // An earlier pattern may have had other colours and grey levels.
  const std::regex own(
      R"(pattern\.(yaml|png)|shot_\d+\.png|rig\.yaml|\w+_(flat|sin)\.png|projector_off\.png)"
      R"(|grey_\d+\.png)");
  write_folder(output, own_entries(output, "pattern.yaml", own), [&](const fs::path& folder) {
    sensing::write_pattern(folder / "pattern.yaml", pattern);
    if (draw.rig)
      sensing::write_rig(folder / "rig.yaml", sensing::rig_of_drawing(*draw.rig, draw.options));
    for (const auto& [name, image] : images) sensing::write_png(folder / name, image);
  });
}

bool shifts_panels(const sensing::Rig& rig) {
  const auto shifts = [](const sensing::ChromaticShift& shift) {
    return shift.beta != 1 || shift.gamma != 0;
  };
  return shifts(rig.red) || shifts(rig.blue);
}

void report(const Settings& settings, const PatternCall& call, const sensing::PatternDesign& design,
            const Drawer& draw) {
  const sensing::Pattern& pattern = design.pattern;
  const std::string axis = pattern.axis == sensing::Axis::x ? "x" : "y";
  Json figures = {{"folder", call.output.string()},
                  {"projector_size", {draw.width, draw.height}},
                  {"colors", Json::array()},
                  {"stripes", pattern.stripes.size()},
                  {"axis", axis},
                  {"period_px", pattern.period}};
  std::string names;
  for (const sensing::PatternColor& color : pattern.colors) {
    figures["colors"].push_back(color.name);
    names += " " + color.name;
  }
  std::string prose;
  if (pattern.multishot) {
    const std::size_t shifts = pattern.multishot->shifts.size();
    const int bits = pattern.multishot->code_bits;
    figures["shifts"] = shifts;
    figures["code_bits"] = bits;
    prose = fmt::format(
        "{} images of a still scene: {} sinusoids of {:g} projector px along {}, then {} of a "
        "code\n",
        shifts + static_cast<std::size_t>(bits), shifts, pattern.period, axis, bits);
  } else {
    prose = fmt::format("{} stripes of {} colours ({}), a sinusoid of {:g} projector px along {}\n",
                        pattern.stripes.size(), pattern.colors.size(), names.substr(1),
                        pattern.period, axis);
  }
  if (call.design.trained) {
    const double before = sensing::largest_overlap(call.design.trained->colors);
    figures["largest_overlap"] = design.largest_overlap;
    figures["largest_overlap_of_trained"] = before;
    prose += fmt::format(
        "The colours are spread: the two most similar are expected to be confused in {:.2g} of the "
        "pixels (trained colours: {:.2g})\n",
        design.largest_overlap, before);
  }
  if (draw.rig) {
    const bool compensated = draw.options.compensate && shifts_panels(*draw.rig);
    figures["camera_period_px"] = design.camera_period;
    figures["phase_per_relative_depth"] = design.phase_per_relative_depth;
    if (!pattern.multishot) figures["edge_tolerance_px"] = design.edge_tolerance;
    figures["rectified"] = draw.options.rectify;
    figures["compensated"] = compensated;
    prose += fmt::format(
        "In the camera a period has at least {:.1f} px; a phase error of 0.01 rad is {:.3f} % of "
        "the depth{}\n",
        design.camera_period, 1 / design.phase_per_relative_depth,
        pattern.multishot ? std::string()
                          : fmt::format("; a stripe edge may be misplaced by up to {:.1f} px",
                                        design.edge_tolerance));
    if (compensated)
      prose += "Red and blue are shifted to match green: in rig.yaml beta is 1 and gamma 0\n";
    if (!pattern.multishot && design.edge_tolerance < kLeastEdgeTolerance) {
      spdlog::warn(
          "the stripes do not reliably identify the period: with this rig the depth moves them too "
          "little. Use the other --axis or a longer --period, place the projector so that it is "
          "displaced from the camera along both axes of the image, or hold still and use "
          "--multishot, which needs no stripes");
    }
    if (design.phase_per_relative_depth < kLeastPhasePerDepth) {
      spdlog::warn(
          "the phase hardly depends on the depth: use the other --axis, or a longer baseline");
    }
  }
  print(
      settings, figures,
      prose + fmt::format("Written to {}{}", call.output.string(),
                          draw.rig ? "; decode its frames with the rig.yaml in this folder" : ""));
}

void make_pattern(const Settings& settings, PatternCall call) {
  check_output_folder({call.rig, call.colors}, call.output);
  if (!call.colors.empty()) call.design.trained = sensing::read_trained_colors(call.colors);
  if (!call.distances.empty()) {
    if (call.distances[0] > call.distances[1]) {
      throw InvalidInput(fmt::format(
          "--distances: the nearest object, at {} mm, is farther away than the farthest, at {} mm; "
          "give the nearest first",
          call.distances[0], call.distances[1]));
    }
    call.design.range = {call.distances[0], call.distances[1]};
  }
  // Without stripes no trough has to show a hue.
  if (call.multishot) {
    call.design.mean = call.design.mean.value_or(kFullContrast);
    call.design.amplitude = call.design.amplitude.value_or(kFullContrast);
  }
  Drawer draw{.rig = {}, .width = call.size[0], .height = call.size[1], .options = call.drawing};
  if (!call.rig.empty()) {
    draw.rig = load_rig(call.rig);
    draw.width = draw.rig->projector.width;
    draw.height = draw.rig->projector.height;
  }
  sensing::PatternDesign design =
      draw.rig
          ? sensing::design_pattern(sensing::rig_of_drawing(*draw.rig, draw.options), call.design)
          : sensing::design_pattern(draw.width, draw.height, call.design);
  if (call.multishot) {
    const sensing::ImageSize panel = draw.panel();
    design.pattern = sensing::multishot_pattern(design.pattern, *call.multishot, panel);
  }
  write_all(call.output, design.pattern, draw, call.grey_steps);
  report(settings, call, design, draw);
}

void add_design_options(CLI::App& command, PatternCall& call) {
  add_fields(command, fields_of(call.design));
  command.get_option("--min-camera-period")->needs("--rig");
  command.add_option("--colors", call.colors,
                     "Trained colours (colors.yaml): choose the colours that the camera "
                     "distinguishes best");
  add_number(command, "--distances", call.distances, above(0),
             "Distance of the nearest and the farthest object [mm] (default: where the views "
             "overlap)")
      ->expected(2)
      ->needs("--rig");
}

}  // namespace

void add_pattern(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<PatternCall>();
  CLI::App* command = app.add_subcommand("pattern", "Design and draw the pattern to project");
  add_required(*command, "-o,--output", call->output, "Folder to write");
  CLI::Option* rig = command->add_option("--rig", call->rig, "Rig to design for (rig.yaml)");
  command
      ->add_option("--size", call->size,
                   "Projector size if there is no rig [px] (default 1024 768)")
      ->expected(2)
      ->excludes(rig);
  add_design_options(*command, *call);
  add_number(*command, "--multishot", call->multishot, at_least(3).at_most(64),
             "Instead of one image, draw several for a static scene: this number "
             "of shifted sinusoids (3 to 64), then a Gray code: shot_00.png, ... in the "
             "order in which to project them, for palpate decode --multishot")
      ->excludes("--colors")
      ->excludes("--stripes")
      ->excludes("--number-of-colors");
  for (CLI::Option* option : add_fields(*command, fields_of(call->drawing)))
    if (option->get_name() != "--bits") option->needs(rig);
  add_number(*command, "--grey-steps", call->grey_steps, at_least(2).at_most(256),
             "Number of grey images for the response")
      ->capture_default_str();
  command->footer(
      "Writes pattern.yaml, pattern.png, rig.yaml (with --rig) and the images to project for "
      "training:\n"
      "R_flat.png, R_sin.png, ... (calibrate colors), white_sin.png (calibrate chromatic),\n"
      "projector_off.png (calibrate crosstalk), grey_000.png ... grey_255.png (calibrate "
      "response),\n"
      "and white_flat.png.\n"
      "All images are linear in the light: use a projector without a gamma curve, or decode with "
      "the\n"
      "response of projector and camera (calibrate response).\n"
      "Examples:\n  palpate pattern --rig rig.yaml --distances 500 900 -o pattern/\n"
      "  palpate pattern --rig rig.yaml --distances 500 900 --multishot 8 -o multishot/");
  command->callback([call, &settings] { make_pattern(settings, *call); });
}

}  // namespace palpate::apps
