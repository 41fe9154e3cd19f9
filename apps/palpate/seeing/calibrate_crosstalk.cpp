// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "palpate/sensing/crosstalk_calibration.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/response.h"
#include "palpate/sensing/rig.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

struct CrosstalkCall {
  fs::path off, red, green, blue, rig, response, output;
};

void calibrate_crosstalk(const Settings& settings, const CrosstalkCall& call) {
  check_outputs({call.off, call.red, call.green, call.blue, call.rig, call.response},
                {call.output});
  sensing::Rig rig = load_rig(call.rig);
  sensing::CrosstalkImages images{sensing::read_frame(call.off), sensing::read_frame(call.red),
                                  sensing::read_frame(call.green), sensing::read_frame(call.blue)};
  if (!call.response.empty()) {
    const sensing::Linearizer linearize(sensing::read_response(call.response));
    for (cv::Mat* image : {&images.off, &images.red, &images.green, &images.blue})
      *image = linearize(*image);
  }
  const sensing::CrosstalkCalibration found = sensing::calibrate_crosstalk(images);
  rig.color_mixing = found.mixing;
  sensing::write_rig(call.output, rig);

  constexpr const char* kNames[] = {"red", "green", "blue"};
  std::string prose = fmt::format("{:<24}{:>10}{:>10}{:>10}\n", "channel sees (%)", kNames[0],
                                  kNames[1], kNames[2]);
  for (int row = 0; row < 3; ++row) {
    prose += fmt::format("{:<24}", kNames[row]);
    for (int column = 0; column < 3; ++column)
      prose += fmt::format("{:>10.2f}", 100 * found.mixing(row, column));
    prose += "\n";
  }
  print(settings,
        {{"mixing", rows_in(found.mixing)},
         {"mixing_deviation", rows_in(found.deviation)},
         {"pixels", found.pixels},
         {"file", call.output.string()}},
        prose + fmt::format("standard deviation at most {:.2f} %, from {} pixels\nWritten to {}",
                            100 * found.deviation.maxCoeff(), found.pixels, call.output.string()));
}

}  // namespace

void add_calibrate_crosstalk(CLI::App& calibrate, const Settings& settings) {
  auto call = std::make_shared<CrosstalkCall>();
  CLI::App* crosstalk = calibrate.add_subcommand(
      "crosstalk",
      "Measure how the camera's channels mix the projector's colours, from three flat images");
  add_required(*crosstalk, "--off", call->off, "Image with the projector off or black");
  add_required(*crosstalk, "--red", call->red, "Image under even red (1, 0, 0)");
  add_required(*crosstalk, "--green", call->green, "Image under even green (0, 1, 0)");
  add_required(*crosstalk, "--blue", call->blue, "Image under even blue (0, 0, 1)");
  add_required(*crosstalk, "--rig", call->rig, "Rig to complete (rig.yaml)");
  crosstalk->add_option("--response", call->response,
                        "Response (response.yaml): the images are linearised first");
  add_required(*crosstalk, "-o,--output", call->output, "Rig with the mixing to write");
  crosstalk->footer(
      "Example:\n  palpate calibrate crosstalk --off off.png --red red.png --green green.png "
      "--blue blue.png --rig rig.yaml -o mixed_rig.yaml");
  crosstalk->callback([call, &settings] { calibrate_crosstalk(settings, *call); });
}

}  // namespace palpate::apps
