// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "operations.h"
#include "palpate/sensing/board_views.h"
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

Rig rig_of_boards() {
  Rig rig;
  rig.camera = {.width = 640, .height = 480, .fx = 800, .fy = 803, .cx = 325, .cy = 237};
  rig.projector = {.width = 512, .height = 384, .fx = 903, .fy = 899, .cx = 252, .cy = 215};
  rig.T_projector_camera.linear() =
      Eigen::AngleAxisd(0.2, Eigen::Vector3d(0.6, -0.8, 0)).toRotationMatrix();
  rig.T_projector_camera.translation() = Eigen::Vector3d(90, 120, -12);
  return rig;
}

/// Exact pixels of a board of 9 x 6 corners in tilted poses.
std::vector<RigView> views_of_board(const Rig& rig, int poses) {
  constexpr Board kBoard{.columns = 9, .rows = 6, .square = 15};
  const Eigen::Matrix2Xd board = board_corners(kBoard);
  std::vector<RigView> views;
  for (int pose = 0; pose < poses; ++pose) {
    const double way = 2.4 * pose;
    const Eigen::AngleAxisd tilt(0.5, Eigen::Vector3d(std::cos(way), std::sin(way), 0));
    RigView view{.name = std::to_string(pose), .board = board};
    view.camera = view.projector = board;
    for (Eigen::Index i = 0; i < board.cols(); ++i) {
      const Eigen::Vector3d flat(board(0, i) - 60, board(1, i) - 37.5, 0);
      const Eigen::Vector3d corner =
          Eigen::Vector3d(5 * pose, -4 * pose, 430 + 25 * pose) + tilt * flat;
      view.camera.col(i) = geometry::distort(rig.camera, corner.hnormalized());
      view.projector.col(i) =
          geometry::distort(rig.projector, (rig.T_projector_camera * corner).hnormalized());
    }
    view.lit_camera = view.camera;
    views.push_back(std::move(view));
  }
  return views;
}

Results calibration(const Input& input, const Change& change) {
  RigCalibrationOptions options;
  change(fields_of(options));
  const Rig rig = rig_of_boards();
  const RigCalibration found =
      calibrate_rig(views_of_board(rig, 5 * input.extent), {rig.camera.width, rig.camera.height},
                    {rig.projector.width, rig.projector.height}, options);
  return {number("fx of the camera", found.rig.camera.fx),
          number("fx of the projector", found.rig.projector.fx),
          number("baseline", found.rig.T_projector_camera.translation().norm())};
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
      {"calibrate_rig", kOptions, calibration},
      {"design_pattern", kOptions | kFrame, design},
      {"simulate", kOptions | kFrame, simulation, 1e-6, 0, 3},
  };
}

}  // namespace palpate::extremes
