// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "boards.h"
#include "operations.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/multishot.h"
#include "palpate/sensing/pattern_design.h"
#include "palpate/sensing/pattern_image.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::extremes {
namespace {

using namespace sensing;

Eigen::VectorXd values_of(const geometry::ImageF& image) {
  return image.cast<double>().reshaped().matrix();
}

Results decoding(const Input& input, const Change& change) {
  DecodeOptions options;
  change(fields_of(options));
  const DecodeResult found =
      Decoder(input.rig, input.pattern, input.colors, options).decode(input.frame);
  return {unknown_allowed(numbers("depths", values_of(found.range.z), kLength)),
          unknown_allowed(numbers("sigma", values_of(found.sigma), kLength)),
          number("transitions", found.transitions), number("regions", found.regions)};
}

/// A rig of fewer pixels.
Rig small_rig(const Input& input) {
  Rig rig = input.rig;
  rig.camera.width /= 16;
  rig.camera.height /= 16;
  for (double* pixels : {&rig.camera.fx, &rig.camera.fy, &rig.camera.cx, &rig.camera.cy})
    *pixels /= 16;
  return rig;
}

/// A ball of 3 times the size in front of the camera; of a wide input, a finer one.
Body ball_in_view(const Input& input) {
  Body body;
  body.mesh = input.ball;
  body.mesh.vertices = (3.0 / input.extent * input.ball.vertices).colwise() +
                       Eigen::Vector3d(0, 0, 800 * input.length);
  return body;
}

Results several_images(const Input& input, const Change& change) {
  MultishotOptions options;
  change(fields_of(options));
  const Rig rig = small_rig(input);
  constexpr double kPeriod = 160;  // [px]: 10 in the camera
  const Pattern pattern =
      multishot_pattern({.period = kPeriod}, 4, {rig.projector.width, rig.projector.height});
  const MultishotDecoder decoder(rig, pattern, options);
  const std::array bodies = {ball_in_view(input)};
  const std::vector<cv::Mat> panels =
      draw_multishot(pattern, rig.projector.width, rig.projector.height);
  const std::vector<cv::Mat> frames =
      simulate(rig, bodies, panels, VirtualSensor{.exposure_steps = 1}).frames;
  std::vector<cv::Mat> images;
  while (static_cast<int>(images.size()) < decoder.images())
    images.insert(images.end(), frames.begin(), frames.end());
  const MultishotResult found = decoder.decode(images);
  return {unknown_allowed(numbers("depths", values_of(found.decoded.range.z), kLength)),
          unknown_allowed(numbers("sigma", values_of(found.decoded.sigma), kLength))};
}

Results calibration(const Input& input, const Change& change) {
  RigCalibrationOptions options;
  change(fields_of(options));
  const Rig rig = rig_of_boards();
  const RigCalibration found = calibrate_rig(input.views, {rig.camera.width, rig.camera.height},
                                             {rig.projector.width, rig.projector.height}, options);
  return {number("fx of the camera", found.rig.camera.fx),
          number("fx of the projector", found.rig.projector.fx),
          number("baseline", found.rig.T_projector_camera.translation().norm(), kLength)};
}

Results design(const Input& input, const Change& change) {
  PatternOptions options{.range = WorkingRange{600 * input.length, 1200 * input.length}};
  change(fields_of(options));
  const PatternDesign found = design_pattern(input.rig, options);
  return {number("period", found.pattern.period), number("camera period", found.camera_period),
          unknown_allowed(number("edges", found.edge_tolerance))};
}

Results simulation(const Input& input, const Change& change) {
  const Rig rig = small_rig(input);
  VirtualSensor sensor;
  sensor.exposure_steps = 1;
  change(fields_of(sensor));
  const std::array bodies = {ball_in_view(input)};
  const std::array panels = {
      cv::Mat(rig.projector.height, rig.projector.width, CV_8UC3, cv::Scalar(200, 150, 100))};
  const Simulation seen = simulate(rig, bodies, panels, sensor);
  return {unknown_allowed(numbers("depths", values_of(seen.truth.range.z), kLength)),
          number("mean of the frame", cv::mean(seen.frames.front())[0])};
}

}  // namespace

std::vector<Operation> sensing_operations() {
  return {
      {"Decoder::decode", kOptions | kFrame, decoding, 0, 0, 3},
      {"MultishotDecoder::decode", kOptions, several_images, 0, 0, 3},
      {"calibrate_rig", kOptions | kViews, calibration, 1e-12},
      {"design_pattern", kOptions | kFrame, design},
      {"simulate", kOptions | kFrame, simulation, 1e-6, 0, 3},
  };
}

}  // namespace palpate::extremes
