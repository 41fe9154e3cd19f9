// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "operations.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/pattern_design.h"
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

Results design(const Input& input, const Change& change) {
  PatternOptions options{.range = WorkingRange{600 * input.length, 1200 * input.length}};
  change(fields_of(options));
  const PatternDesign found = design_pattern(input.rig, options);
  return {number("period", found.pattern.period), number("camera period", found.camera_period),
          unknown_allowed(number("edges", found.edge_tolerance))};
}

Results simulation(const Input& input, const Change& change) {
  Body body;
  body.mesh = input.ball;
  body.mesh.vertices =
      (3 * input.ball.vertices).colwise() + Eigen::Vector3d(0, 0, 800 * input.length);
  Rig rig = input.rig;  // of fewer pixels
  rig.camera.width /= 16;
  rig.camera.height /= 16;
  for (double* pixels : {&rig.camera.fx, &rig.camera.fy, &rig.camera.cx, &rig.camera.cy})
    *pixels /= 16;
  VirtualSensor sensor;
  sensor.exposure_steps = 1;
  change(fields_of(sensor));
  const std::array bodies = {body};
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
      {"design_pattern", kOptions | kFrame, design},
      {"simulate", kOptions | kFrame, simulation, 1e-6, 0, 3},
  };
}

}  // namespace palpate::extremes
