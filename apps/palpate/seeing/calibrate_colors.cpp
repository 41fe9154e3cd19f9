// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/pictures/draw_hues.h"
#include "palpate/sensing/color_overlap.h"
#include "palpate/sensing/response.h"
#include "palpate/sensing/trained_colors.h"
#include "shared/command_line.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

/// A colour that is mistaken for another one this often causes a warning. A transition needs two
/// correct colours, and a depth needs several transitions that agree.
constexpr double kWarn = 0.05;
/// Above this probability two colours cannot be distinguished.
constexpr double kRefuse = 0.3;

struct ColorsCall {
  std::vector<fs::path> folders;
  fs::path output, response, picture;
};

/// Formats a matrix in percent.
std::string as_table(const std::string& title, const sensing::TrainedColors& trained,
                     const Eigen::MatrixXd& overlap) {
  std::string text = fmt::format("{:<34}", title);
  for (const sensing::TrainedColor& color : trained.colors)
    text += fmt::format("{:>8}", color.name);
  text += "\n";
  for (Eigen::Index row = 0; row < overlap.rows(); ++row) {
    text += fmt::format("{:<34}", "  " + trained.colors[static_cast<std::size_t>(row)].name);
    for (const double share : overlap.row(row)) text += fmt::format("{:>8.2f}", 100 * share);
    text += "\n";
  }
  return text;
}

/// Warns about colours that are easily confused.
/// \throws InvalidInput if two colours cannot be distinguished.
void judge(const ColorsCall& call, const sensing::TrainedColors& trained,
           const Eigen::MatrixXd& overlap) {
  for (const sensing::ConfusedColors& pair : sensing::find_confused(overlap, kWarn)) {
    const std::string what = fmt::format(
        "{}: {} is mistaken for {} in {:.0f} % of the pixels", call.folders.front().string(),
        trained.colors[static_cast<std::size_t>(pair.first)].name,
        trained.colors[static_cast<std::size_t>(pair.second)].name, 100 * pair.probability);
    if (pair.probability > kRefuse) {
      throw InvalidInput(
          what +
          ": these colours cannot be distinguished. Spread the colours of the pattern, "
          "or check that the images have the right names.");
    }
    spdlog::warn("{}; colours with more different hues would be safer.", what);
  }
}

void draw_picture(const fs::path& png, const std::vector<sensing::NamedImages>& images,
                  const sensing::TrainedColors& trained, const sensing::TrainingOptions& options) {
  std::vector<pictures::HueDistribution> hues;
  for (const sensing::TrainedColor& color : trained.colors) {
    pictures::HueDistribution one{color.name, color.mean, std::sqrt(color.variance), {}};
    for (const sensing::NamedImages& named : images) {
      if (named.name == color.name) one.histogram = sensing::hue_histogram(named, 360, options);
    }
    hues.push_back(std::move(one));
  }
  pictures::draw_hues(png, hues, "Hues of the training images and fitted Gaussians");
}

void calibrate_colors(const Settings& settings, const ColorsCall& call) {
  std::vector<fs::path> inputs = call.folders;
  inputs.push_back(call.response);
  std::vector<sensing::NamedImages> images = sensing::read_training_images(call.folders);
  for (const sensing::NamedImages& named : images)
    inputs.insert(inputs.end(), named.sources.begin(), named.sources.end());
  check_outputs(inputs, {call.output, call.picture});
  if (!call.response.empty()) {
    const sensing::Linearizer linearize(sensing::read_response(call.response));
    for (sensing::NamedImages& named : images)
      for (cv::Mat& image : named.images) image = linearize(image);
  }
  const sensing::TrainedColors trained = sensing::train_colors(images);
  const Eigen::MatrixXd predicted = sensing::predict_overlap(trained);
  const Eigen::MatrixXd measured = sensing::measure_overlap(images, trained);
  judge(call, trained, predicted.cwiseMax(measured));
  sensing::write_trained_colors(call.output, trained);
  if (!call.picture.empty()) draw_picture(call.picture, images, trained, {});

  Json figures = {{"colors", Json::array()},
                  {"overlap_predicted", rows_in(predicted)},
                  {"overlap_measured", rows_in(measured)},
                  {"file", call.output.string()}};
  std::string prose;
  for (const sensing::TrainedColor& color : trained.colors) {
    figures["colors"].push_back({{"name", color.name},
                                 {"mean", color.mean},
                                 {"variance", color.variance},
                                 {"pixels", color.pixels}});
    prose += fmt::format("{}: hue {:.1f} degrees, standard deviation {:.1f}, from {} pixels\n",
                         color.name, color.mean / kDegree, std::sqrt(color.variance) / kDegree,
                         color.pixels);
  }
  prose += as_table("classified as (%), predicted", trained, predicted);
  prose += as_table("classified as (%), measured", trained, measured);
  print(settings, figures, prose + "Written to " + call.output.string());
}

}  // namespace

void add_calibrate_colors(CLI::App& calibrate, const Settings& settings) {
  auto call = std::make_shared<ColorsCall>();
  CLI::App* colors =
      calibrate.add_subcommand("colors", "Train the hue classifier with single-colour images");
  add_required(*colors, "FOLDER", call->folders,
               "Folders of images R_flat.png, R_sin.png, ...: a scene lit by one pattern colour");
  add_required(*colors, "-o,--output", call->output,
               "File of trained colours to write (colors.yaml)");
  colors->add_option(
      "--response", call->response,
      "Response of projector and camera (response.yaml): linearise the images first, "
      "as decode does with --response");
  colors->add_option("--picture", call->picture,
                     "Also draw the hues and the fitted Gaussians (PNG)");
  colors->footer(
      "Example:\n  palpate calibrate colors training/ -o colors.yaml --picture hues.png");
  colors->callback([call, &settings] { calibrate_colors(settings, *call); });
}

}  // namespace palpate::apps
