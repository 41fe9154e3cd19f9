// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <Eigen/Core>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/pictures/draw_section.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/harmonics.h"
#include "palpate/sensing/response.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

struct ResponseCall {
  fs::path ramp, output, picture, check, response, rig, pattern;
  double distance = 0;
};

/// Formats a harmonic.
std::string in_prose(const std::optional<sensing::Harmonic>& harmonic) {
  if (!harmonic) return "unknown at this period";
  return fmt::format("{:+.2f} +- {:.2f} %", 100 * harmonic->ratio, 100 * harmonic->deviation);
}

std::vector<std::string> channel_names(std::size_t count) {
  if (count == 1) return {"grey"};
  return {"blue", "green", "red"};
}

void report_curves(const sensing::Response& response, Json& figures, std::string& prose) {
  const std::vector<std::string> names = channel_names(response.channels.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const sensing::ResponseCurve& curve = response.channels[i];
    figures["channels"].push_back({{"name", names[i]},
                                   {"gamma", curve.gamma},
                                   {"gamma_deviation", curve.gamma_deviation},
                                   {"misfit", curve.misfit},
                                   {"black", curve.black},
                                   {"gain", curve.gain},
                                   {"last_level", curve.levels.back()},
                                   {"levels", curve.levels.size()}});
    prose += fmt::format(
        "{}: gamma {:.3f} +- {:.3f}, RMS deviation from the power law {:.2f} %; black {:.1f} %, "
        "white {:.1f} % of full scale; {} levels up to {:.0f} of 255\n",
        names[i], curve.gamma, curve.gamma_deviation, 100 * curve.misfit, 100 * curve.black,
        100 * (curve.black + curve.gain), curve.levels.size(), 255 * curve.levels.back());
  }
}

void draw_curves(const fs::path& png, const sensing::Response& response) {
  std::vector<pictures::SectionSeries> series;
  const std::vector<std::string> names = channel_names(response.channels.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const sensing::ResponseCurve& curve = response.channels[i];
    const auto count = static_cast<Eigen::Index>(curve.levels.size());
    series.push_back({names[i], Eigen::Map<const Eigen::VectorXd>(curve.levels.data(), count),
                      Eigen::Map<const Eigen::VectorXd>(curve.light.data(), count)});
  }
  pictures::draw_section(png, series, "Response of projector and camera",
                         {"projected level", "light (1 at the last level)"});
}

/// Adds the figures of one check; `what` names it.
sensing::HarmonicCheck report_harmonics(const ResponseCall& call, const cv::Mat& frame,
                                        const std::string& what, Json& figures,
                                        std::string& prose) {
  sensing::HarmonicCheck check;
  try {
    check = sensing::check_harmonics(frame);
  } catch (const InvalidInput& error) {
    throw InvalidInput(call.check.string() + ": " + error.what());
  }
  Json item = {{"period_px", check.period},
               {"along", check.along_x ? "x" : "y"},
               {"modulation", check.modulation},
               {"places", check.places}};
  if (check.second) {
    item["second"] = check.second->ratio;
    item["second_deviation"] = check.second->deviation;
  }
  if (check.third) {
    item["third"] = check.third->ratio;
    item["third_deviation"] = check.third->deviation;
  }
  item["phase_wave"] = check.phase_wave;
  prose += fmt::format(
      "{}, {}: a sinusoid of {:.1f} px along {}, modulation {:.2f}; second harmonic {}, third {}; "
      "phase error {:.4f} rad RMS",
      call.check.string(), what, check.period, check.along_x ? "x" : "y", check.modulation,
      in_prose(check.second), in_prose(check.third), check.phase_wave);
  if (call.distance > 0) {
    const double depth_wave =
        check.phase_wave * sensing::depth_per_radian(load_rig(call.rig),
                                                     sensing::read_pattern(call.pattern),
                                                     call.distance);
    item["depth_wave"] = depth_wave;
    prose += fmt::format(", depth error {:.3f} mm RMS at {:.0f} mm", depth_wave, call.distance);
  }
  prose += "\n";
  item["distorted"] = check.distorted;
  figures["harmonics"][what] = item;
  return check;
}

/// Checks the frame unchanged and, if there is a response, linearised.
void check_frame(const ResponseCall& call, const std::optional<sensing::Response>& response,
                 Json& figures, std::string& prose) {
  const cv::Mat frame = sensing::read_frame(call.check);
  bool distorted = report_harmonics(call, frame, "as it is", figures, prose).distorted;
  if (response) {
    const cv::Mat linear = sensing::linearize(frame, *response);
    distorted = report_harmonics(call, linear, "linearised", figures, prose).distorted;
  }
  if (!distorted) return;
  spdlog::warn(
      "{}: the sinusoid is distorted, which causes waves in the depth. {}", call.check.string(),
      response
          ? "Either the response does not match: record it and the frame with the same projector "
            "mode, exposure and camera settings. Or the camera blurs the sinusoid, which no "
            "response can correct: use a longer period, a sharper lens or a projector without "
            "gamma."
          : "Measure the response of projector and camera (palpate calibrate response "
            "FOLDER -o response.yaml) and pass it to decode.");
}

void check_call(const ResponseCall& call) {
  if (call.ramp.empty() && call.check.empty())
    throw InvalidInput("calibrate response: pass a folder of grey images and -o, or --check.");
  if (call.ramp.empty() != call.output.empty())
    throw InvalidInput("calibrate response: a folder of grey images and -o need each other.");
  if (!call.ramp.empty() && !call.response.empty())
    throw InvalidInput("calibrate response: --response works only with --check and no folder.");
  const bool has_geometry = !call.rig.empty() && !call.pattern.empty() && call.distance > 0;
  const bool has_some = !call.rig.empty() || !call.pattern.empty() || call.distance > 0;
  if (has_some && (!has_geometry || call.check.empty()))
    throw InvalidInput(
        "calibrate response: --rig, --pattern and --distance need each other and --check.");
}

void calibrate_response(const Settings& settings, const ResponseCall& call) {
  check_call(call);
  std::vector<fs::path> inputs = {call.ramp, call.check, call.response, call.rig, call.pattern};
  std::vector<sensing::GreyImage> ramp;
  if (!call.ramp.empty()) ramp = sensing::read_grey_ramp(call.ramp);
  for (const sensing::GreyImage& grey : ramp) inputs.emplace_back(grey.name);
  check_outputs(inputs, {call.output, call.picture});
  Json figures;
  std::string prose;
  std::optional<sensing::Response> response;
  if (!call.ramp.empty()) {
    response = sensing::calibrate_response(ramp);
    report_curves(*response, figures, prose);
  } else if (!call.response.empty()) {
    response = sensing::read_response(call.response);
  }
  if (!call.check.empty()) check_frame(call, response, figures, prose);
  if (!call.output.empty()) {
    sensing::write_response(call.output, *response);
    figures["file"] = call.output.string();
    prose += "Written to " + call.output.string() + "\n";
  }
  if (!call.picture.empty() && response) draw_curves(call.picture, *response);
  prose.pop_back();
  print(settings, figures, prose);
}

}  // namespace

void add_calibrate_response(CLI::App& calibrate, const Settings& settings) {
  auto call = std::make_shared<ResponseCall>();
  CLI::App* response = calibrate.add_subcommand(
      "response", "Fit the response to images of uniform greys; check a sinusoid for distortion");
  response->add_option(
      "FOLDER", call->ramp,
      "Images grey_000.png ... grey_255.png of a still scene; the number is the projected level");
  response->add_option("-o,--output", call->output, "Response file to write (response.yaml)");
  response->add_option("--picture", call->picture, "Also draw the curves (PNG)");
  response->add_option(
      "--check", call->check,
      "Frame of the white sinusoid: measure its second and third harmonic, before and after "
      "linearisation");
  response->add_option("--response", call->response, "With --check: an existing response");
  response->add_option("--rig", call->rig, "With --check: rig for predicting the depth error");
  response->add_option("--pattern", call->pattern, "With --rig: the pattern");
  add_number(*response, "--distance", call->distance, above(0),
             "With --rig: distance of the surface [mm]");
  response->footer(
      "Keep the exposure fixed and the brightest image below full scale. Use 16 levels or more.\n"
      "Train the colours with linearised images too: calibrate colors --response.\n"
      "Examples:\n  palpate calibrate response greys/ -o response.yaml --check white_sin.png\n"
      "  palpate decode frames/ --response response.yaml ...");
  response->callback([call, &settings] { calibrate_response(settings, *call); });
}

}  // namespace palpate::apps
