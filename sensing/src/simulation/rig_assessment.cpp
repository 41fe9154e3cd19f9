// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_assessment.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/sensing/bayer.h"

namespace palpate::sensing {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

void check_options(const AssessmentOptions& options) {
  require("AssessmentOptions::counted_bodies", options.counted_bodies, at_least(1));
  require("AssessmentOptions::max_incidence", options.max_incidence,
          above(0).at_most(std::numbers::pi / 2), "rad");
}

/// The lit pixel nearest to the image centre.
std::optional<Anchor> anchor_of(const SceneTruth& truth) {
  const double middle_row = static_cast<double>(truth.lit.rows() - 1) / 2;
  const double middle_column = static_cast<double>(truth.lit.cols() - 1) / 2;
  std::optional<Anchor> anchor;
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index v = 0; v < truth.lit.rows(); ++v) {
    for (Eigen::Index u = 0; u < truth.lit.cols(); ++u) {
      const double away =
          std::hypot(static_cast<double>(v) - middle_row, static_cast<double>(u) - middle_column);
      if (!truth.lit(v, u) || away >= nearest) continue;
      nearest = away;
      anchor = Anchor{.u_px = static_cast<double>(u),
                      .v_px = static_cast<double>(v),
                      .z = static_cast<double>(truth.range.z(v, u))};
    }
  }
  return anchor;
}

/// A frame as the decoder takes it.
cv::Mat in_color(const cv::Mat& frame, const VirtualSensor& sensor) {
  return sensor.readout == Readout::mosaic ? demosaic(frame, BayerPattern::rggb) : frame;
}

}  // namespace

RigAssessment assess(const DecodeResult& decoded, const SceneTruth& truth,
                     const AssessmentOptions& options) {
  check_options(options);
  const auto fits = [&truth](const auto& image) {
    return image.rows() == truth.body.rows() && image.cols() == truth.body.cols();
  };
  if (!fits(decoded.range.z) || !fits(decoded.reasons))
    throw InvalidInput("assess: the depths or reasons are not of the size of the truth");
  const int bodies = options.counted_bodies.value_or(std::numeric_limits<int>::max());
  const PixelMask scenery = truth.body >= bodies;
  RigAssessment found;
  found.score = geometry::score_range_map(scenery.select(kUnknown, decoded.range.z),
                                          scenery.select(kUnknown, truth.range.z), truth.lit);
  for (Eigen::Index v = 0; v < truth.body.rows(); ++v) {
    for (Eigen::Index u = 0; u < truth.body.cols(); ++u) {
      if (scenery(v, u)) continue;
      const bool measured = std::isfinite(decoded.range.z(v, u));
      if (truth.body(v, u) < 0) {
        found.stray += measured;
        continue;
      }
      ++found.visible;
      if (!truth.lit(v, u)) {
        ++(truth.covered(v, u) ? found.dark : found.outside);
        continue;
      }
      const bool faces = static_cast<double>(truth.incidence(v, u)) <= options.max_incidence;
      found.facing += faces;
      found.facing_covered += faces && measured;
      ++found.reasons[decoded.reasons(v, u)];
    }
  }
  return found;
}

std::vector<cv::Mat> color_panels(const Pattern& pattern, const geometry::Camera& projector) {
  std::vector<cv::Mat> panels;
  for (const PatternColor& color : pattern.colors) {
    panels.emplace_back(projector.height, projector.width, CV_32FC3,
                        cv::Scalar(color.rgb[2], color.rgb[1], color.rgb[0]));
  }
  return panels;
}

RigTrial simulate_shot(const Rig& rig, const Pattern& pattern, const cv::Mat& panel,
                       std::span<const Body> bodies, const VirtualSensor& sensor,
                       const ShotOptions& options) {
  check_pattern(pattern, "simulate_shot: pattern");
  check_rig(rig, "simulate_shot: rig");
  std::vector<cv::Mat> panels;
  if (options.training) panels = color_panels(pattern, rig.projector);
  panels.insert(panels.begin(), panel);
  RigTrial trial;
  trial.simulation = simulate(rig, bodies, panels, sensor, pattern.axis, options.first_frame);
  for (std::size_t i = 1; i < panels.size(); ++i)
    trial.training.push_back({pattern.colors[i - 1].name, {trial.simulation.frames[i]}});
  return trial;
}

RigTrial try_rig(const Rig& rig, const Pattern& pattern, const cv::Mat& panel,
                 std::span<const Body> bodies, const VirtualSensor& sensor,
                 const TrialOptions& options) {
  check_pattern(pattern, "try_rig: pattern");
  check_rig(rig, "try_rig: rig");
  RigTrial trial =
      simulate_shot(rig, pattern, panel, bodies, sensor, {.first_frame = options.first_frame});
  if (!trial.simulation.truth.lit.any()) {
    trial.failure = "no light of the projector falls on what the camera sees";
    return trial;
  }
  std::vector<NamedImages> training = trial.training;
  for (NamedImages& color : training) color.images[0] = in_color(color.images[0], sensor);
  try {
    if (!training.empty()) trial.colors = train_colors(training);
  } catch (const InvalidInput& error) {
    trial.failure = error.what();
    return trial;
  }
  DecodeOptions decode = options.decode;
  if (decode.anchors.empty() && pattern.stripes.empty()) {
    if (const auto anchor = anchor_of(trial.simulation.truth)) decode.anchors = {*anchor};
  }
  const Decoder decoder(options.decoder_rig.value_or(rig), pattern, trial.colors, decode);
  trial.decoded = decoder.decode(in_color(trial.simulation.frames[0], sensor));
  return trial;
}

}  // namespace palpate::sensing
