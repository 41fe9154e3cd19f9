// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/sensing/chromatic_calibration.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/pattern_image.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

/// `--distances` apply to this central part of the image's width and height.
constexpr int kMiddle = 16;

struct ChromaticCall {
  std::vector<fs::path> images;
  std::vector<double> distances;
  std::vector<fs::path> ranges;
  fs::path rig, pattern, output;
};

/// Constant depth, that of the image centre. On a tilted plane it is too small on one side and too
/// large on the other, but right in the median.
geometry::ImageF depth_in_the_middle(double distance, const geometry::Camera& camera) {
  geometry::ImageF depth = geometry::ImageF::Constant(camera.height, camera.width,
                                                      std::numeric_limits<float>::quiet_NaN());
  const int height = std::max(1, camera.height / kMiddle);
  const int width = std::max(1, camera.width / kMiddle);
  depth.block((camera.height - height) / 2, (camera.width - width) / 2, height, width)
      .setConstant(static_cast<float>(distance));
  return depth;
}

std::vector<sensing::WhiteImage> read_images(const ChromaticCall& call, const sensing::Rig& rig) {
  const std::vector<fs::path> paths = list_frames(call.images);
  const std::vector<fs::path> ranges =
      call.ranges.empty() ? std::vector<fs::path>() : list_frames(call.ranges);
  const auto check_count = [&](std::size_t count, const char* what) {
    if (count == 0 || count == paths.size()) return;
    throw InvalidInput(fmt::format("{}: {} for {} images; one for each image is expected", what,
                                   count, paths.size()));
  };
  check_count(call.distances.size(), "--distances");
  check_count(ranges.size(), "--range");
  std::vector<sensing::WhiteImage> images;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    sensing::WhiteImage white;
    white.name = paths[i].string();
    white.image = sensing::read_frame(paths[i]);
    if (!call.distances.empty()) white.depth = depth_in_the_middle(call.distances[i], rig.camera);
    if (!ranges.empty()) check_is_depths(ranges[i]);
    if (!ranges.empty()) white.depth = geometry::read_depth_tiff(ranges[i]);
    images.push_back(std::move(white));
  }
  return images;
}

Json figures_of(const sensing::ChannelCalibration& channel) {
  return {{"alpha", channel.shift.alpha},     {"alpha_deviation", channel.deviation.alpha},
          {"beta", channel.shift.beta},       {"beta_deviation", channel.deviation.beta},
          {"gamma", channel.shift.gamma},     {"gamma_deviation", channel.deviation.gamma},
          {"rms_before", channel.rms_before}, {"rms_after", channel.rms_after},
          {"cells", channel.cells},           {"outliers", channel.outliers},
          {"separation", channel.separation}};
}

std::string prose_of(const char* name, const sensing::ChannelCalibration& channel) {
  return fmt::format(
      "{}: alpha {:.6f} +- {:.1e}, beta {:.6f} +- {:.1e}, gamma {:.7f} +- {:.1e}; phase relative "
      "to green {:.4f} rad RMS, compensated {:.4f} (from {} points, {} outliers)\n",
      name, channel.shift.alpha, channel.deviation.alpha, channel.shift.beta,
      channel.deviation.beta, channel.shift.gamma, channel.deviation.gamma, channel.rms_before,
      channel.rms_after, channel.cells, channel.outliers);
}

void calibrate_chromatic(const Settings& settings, const ChromaticCall& call) {
  std::vector<fs::path> inputs = {call.rig, call.pattern};
  inputs.insert(inputs.end(), call.images.begin(), call.images.end());
  inputs.insert(inputs.end(), call.ranges.begin(), call.ranges.end());
  check_outputs(inputs, {call.output});
  sensing::Rig rig = load_rig(call.rig);
  const sensing::Pattern pattern = sensing::read_pattern(call.pattern);
  sensing::check_pattern_fits(sensing::without_stripes(pattern), rig.projector,
                              call.pattern.string());
  const sensing::ChromaticCalibration found =
      sensing::calibrate_chromatic(read_images(call, rig), rig, pattern);
  rig.red = found.red.shift;
  rig.blue = found.blue.shift;
  sensing::write_rig(call.output, rig);

  Json images = Json::array();
  std::string prose;
  for (const sensing::WhiteImageUse& use : found.images) {
    if (!use.median_depth) {
      spdlog::warn("{}: not used: {}", use.name, use.problem);
      images.push_back({{"image", use.name}, {"cells", 0}, {"problem", use.problem}});
      continue;
    }
    images.push_back(
        {{"image", use.name},
         {"cells", use.cells},
         {"median_depth", *use.median_depth},
         {"period_deviation", use.period_deviation ? Json(*use.period_deviation) : Json()}});
    prose += fmt::format("{}: phases at {} points, median depth {:.1f} mm\n", use.name, use.cells,
                         *use.median_depth);
  }
  const double separation = std::min(found.red.separation, found.blue.separation);
  if (separation < sensing::kPoorSeparation) {
    spdlog::warn(
        "the surfaces hardly separate alpha, beta and gamma (separation {:.3f}; at least {:.2f} is "
        "needed): add images at other distances, or of tilted surfaces",
        separation, sensing::kPoorSeparation);
  }
  const Json figures = {{"red", figures_of(found.red)},
                        {"blue", figures_of(found.blue)},
                        {"images", images},
                        {"file", call.output.string()}};
  print(settings, figures,
        prose + prose_of("red", found.red) + prose_of("blue", found.blue) + "Written to " +
            call.output.string());
}

}  // namespace

void add_calibrate_chromatic(CLI::App& calibrate, const Settings& settings) {
  auto call = std::make_shared<ChromaticCall>();
  CLI::App* command = calibrate.add_subcommand(
      "chromatic", "Estimate the shifts of red and blue from images of a white sinusoid");
  add_required(*command, "IMAGE", call->images,
               "Images (or folders of images) of surfaces at several distances under the "
               "pattern's sinusoid in white (white_sin.png)");
  add_required(*command, "--rig", call->rig,
               "Rig (rig.yaml); of its chromatic values, only the mixing is used");
  add_required(*command, "--pattern", call->pattern, "Pattern; its stripes are not used");
  add_required(*command, "-o,--output", call->output, "Rig file to write, with the result");
  CLI::Option* distances =
      add_number(*command, "--distances", call->distances, above(0),
                 "Distance of each surface at the image centre [mm], accurate to about a period; "
                 "needed only if the surfaces are not plane or the rig cannot determine the period "
                 "on a plane");
  command
      ->add_option("--range", call->ranges,
                   "Range maps of the surfaces instead (from `palpate decode`), one per image")
      ->excludes(distances);
  command->footer(
      "Example:\n  palpate calibrate chromatic white/ --rig rig.yaml --pattern pattern.yaml -o "
      "rig_chromatic.yaml");
  command->callback([call, &settings] { calibrate_chromatic(settings, *call); });
}

}  // namespace palpate::apps
