// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// How well simulated rigs are calibrated from simulated boards, for docs/calibration.md: errors of
// depths at the distances of the boards, and these errors over the deviations that the rig's
// covariance predicts. `calibration_trade 1 2` makes the table for the seeds 1 and 2.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "palpate/geometry/median.h"
#include "palpate/sensing/board_views.h"
#include "palpate/sensing/gray_code.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/virtual_sensor.h"
#include "setup/rig_jacobian.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

constexpr Board kBoard{.columns = 9, .rows = 6, .square = 25};
constexpr int kPoses = 12;

/// The same numbers everywhere, unlike std::uniform_real_distribution.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967296.0;
  }

 private:
  std::mt19937 engine_;
};

struct Setup {
  std::string name;
  Rig rig;
  double distance = 0;  ///< [mm] of the boards, +- 15 %
};

/// A projector at `lamp` whose axis meets the camera's axis at the depth z [mm].
void aim(Rig& rig, const Eigen::Vector3d& lamp, double z) {
  const Eigen::Vector3d forward = (Eigen::Vector3d(0, 0, z) - lamp).normalized();
  const Eigen::Vector3d right = (Eigen::Vector3d::UnitX() - forward * forward.x()).normalized();
  Eigen::Matrix3d R;
  R << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  rig.T_projector_camera.linear() = R;
  rig.T_projector_camera.translation() = -R * lamp;
}

/// Three shapes of rig: projector below and converging, a long sideways baseline, and wide angles
/// side by side; the seed varies focal lengths, principal points and the baseline.
std::vector<Setup> setups(unsigned seed) {
  Setup below{"projector above, converging", {}, 620};
  below.rig.camera = {.width = 640, .height = 480, .fx = 800, .fy = 801, .cx = 322, .cy = 238};
  below.rig.camera.distortion = {-0.10, 0.06, 0.0008, -0.0006};
  below.rig.projector = {.width = 800, .height = 600, .fx = 1000, .fy = 1002, .cx = 402, .cy = 330};
  below.rig.projector.distortion = {-0.04, 0.03, 0.0003, 0.0005};
  aim(below.rig, {20, 150, 10}, 700);
  Setup aside{"projector aside, long baseline", below.rig, 880};
  aside.rig.camera.fx = aside.rig.camera.fy = 1100;
  aside.rig.projector = {.width = 912, .height = 684, .fx = 1500, .fy = 1500, .cx = 460, .cy = 300};
  aside.rig.projector.distortion = {0.02, -0.02, -0.0004, 0.0003};
  aim(aside.rig, {250, 30, -20}, 900);
  Setup wide{"parallel, wide angles", below.rig, 400};
  wide.rig.camera.fx = wide.rig.camera.fy = 520;
  wide.rig.camera.distortion = {-0.2, 0.07, -0.0005, 0.0004};
  wide.rig.projector = {.width = 640, .height = 480, .fx = 700, .fy = 698, .cx = 318, .cy = 85};
  wide.rig.projector.distortion = {-0.06, 0.02};
  wide.rig.T_projector_camera.setIdentity();
  wide.rig.T_projector_camera.translation() = Eigen::Vector3d(10, 90, 5);
  std::vector<Setup> all{below, aside, wide};
  Random random(seed);
  for (Setup& setup : all) {
    geometry::Camera& camera = setup.rig.camera;
    geometry::Camera& projector = setup.rig.projector;
    camera.fx *= random.between(0.95, 1.05);
    camera.fy = camera.fx * random.between(0.999, 1.001);
    projector.fx *= random.between(0.95, 1.05);
    projector.fy = projector.fx * random.between(0.999, 1.001);
    camera.cx += random.between(-8, 8);
    camera.cy += random.between(-8, 8);
    setup.rig.T_projector_camera.translation() *= random.between(0.9, 1.1);
  }
  return all;
}

/// Poses of the board: one nearly level, the others tilted by 22 to 40 degrees to all sides.
std::vector<Eigen::Isometry3d> poses(const Setup& setup, unsigned seed) {
  Random random(1000 + seed);
  std::vector<Eigen::Isometry3d> result;
  for (int i = 0; i < kPoses; ++i) {
    const double way = 5 * 2 * std::numbers::pi * i / kPoses + random.between(-0.3, 0.3);
    const double tilt = i == 0 ? 0.05 : random.between(0.38, 0.70);
    const double z = setup.distance * (1 + 0.15 * std::cos(2.4 * i) + random.between(-0.03, 0.03));
    const double aside = 0.3 * z / setup.rig.camera.fx;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(
        Eigen::Vector3d(aside * random.between(-320, 320), aside * random.between(-240, 240), z));
    pose.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(way), std::sin(way), 0)));
    pose.rotate(Eigen::AngleAxisd(random.between(-0.4, 0.4), Eigen::Vector3d::UnitZ()));
    pose.translate(Eigen::Vector3d(-(kBoard.columns - 1) * kBoard.square / 2,
                                   -(kBoard.rows - 1) * kBoard.square / 2, 0));
    result.push_back(pose);
  }
  return result;
}

Body board_at(const Eigen::Isometry3d& T_camera_board) {
  constexpr int kPixels = 60;  // of the print, a square
  constexpr int kAround = 1;   // squares of margin
  cv::Mat print((kBoard.rows + 1 + 2 * kAround) * kPixels,
                (kBoard.columns + 1 + 2 * kAround) * kPixels, CV_8U, cv::Scalar(230));
  for (int row = 0; row <= kBoard.rows; ++row) {
    for (int column = row % 2; column <= kBoard.columns; column += 2)
      print(cv::Rect((column + kAround) * kPixels, (row + kAround) * kPixels, kPixels, kPixels)) =
          20;
  }
  const double left = -(1 + kAround) * kBoard.square;
  const double right = (kBoard.columns + kAround) * kBoard.square;
  const double bottom = (kBoard.rows + kAround) * kBoard.square;
  Body body;
  body.mesh.vertices.resize(3, 4);
  body.mesh.vertices << left, right, right, left, left, left, bottom, bottom, 0, 0, 0, 0;
  body.mesh.vertices = T_camera_board * body.mesh.vertices;
  body.mesh.triangles.resize(3, 2);
  body.mesh.triangles << 0, 0, 1, 2, 2, 3;
  body.texture = print;
  body.texture_coordinates.resize(2, 4);
  body.texture_coordinates << 0, 1, 1, 0, 1, 1, 0, 0;
  body.reflectance = {1, 1, 1};
  return body;
}

RigView photographed(const Rig& rig, const Eigen::Isometry3d& pose, std::uint64_t seed) {
  const ImageSize panel{rig.projector.width, rig.projector.height};
  std::vector<cv::Mat> panels = draw_gray_code(panel);
  panels.insert(panels.begin(), panels[panels.size() - 2]);  // white sets the exposure
  const VirtualSensor sensor{.projector_blur = 0.5,
                             .ambient = 0.05,
                             .samples_per_axis = 3,
                             .exposure_steps = 1,
                             .seed = seed};
  const std::vector<Body> bodies{board_at(pose)};
  Simulation simulation = simulate(rig, bodies, panels, sensor);
  simulation.frames.erase(simulation.frames.begin());
  for (cv::Mat& frame : simulation.frames) cv::cvtColor(frame, frame, cv::COLOR_BGR2GRAY);
  return view_from_gray_code(simulation.frames, kBoard, panel);
}

struct Score {
  double error = 0;  ///< median, as a share of the depth
  double ratio = 0;  ///< RMS of the errors over their predicted deviations
};
Score score(const Rig& truth, const Rig& found, double nearest, double farthest) {
  const Eigen::Vector3d t = truth.T_projector_camera.translation();
  const Axis axis = std::abs(t.x()) > std::abs(t.y()) ? Axis::x : Axis::y;
  const Triangulation exact(truth);
  const Triangulation calibrated(found);
  std::vector<double> errors;
  double squares = 0;
  for (int v = 20; v < truth.camera.height; v += 40) {
    for (int u = 20; u < truth.camera.width; u += 40) {
      for (const double part : {0.1, 0.5, 0.9}) {
        const double z = nearest + part * (farthest - nearest);
        const Eigen::Vector2d pixel(u, v);
        const Eigen::Vector2d lit_by =
            exact.project(exact.direction(geometry::undistort(truth.camera, pixel)), z);
        if (!exact.on_panel(lit_by)) continue;
        const double depth =
            calibrated.depth(calibrated.direction(geometry::undistort(found.camera, pixel)), axis,
                             lit_by[axis == Axis::x ? 0 : 1]);
        const PanelView view = panel_view(found, axis, look_back(found.camera, pixel),
                                          Eigen::VectorXd::Constant(1, 1 / z));
        const double sigma = std::sqrt(inverse_depth_variance(found, view)[0]) * z * z;
        errors.push_back(std::abs(depth / z - 1));
        squares += (depth - z) * (depth - z) / (sigma * sigma);
      }
    }
  }
  const auto count = static_cast<double>(errors.size());
  return {geometry::median(std::move(errors)), std::sqrt(squares / count)};
}

void run(unsigned seed) {
  for (const Setup& setup : setups(seed)) {
    std::vector<RigView> views;
    double nearest = 1e9, farthest = 0;
    for (const Eigen::Isometry3d& pose : poses(setup, seed)) {
      views.push_back(photographed(setup.rig, pose, 100 * seed + views.size()));
      views.back().name = fmt::format("pose {}", views.size());
      nearest = std::min(nearest, pose.translation().z());
      farthest = std::max(farthest, pose.translation().z());
    }
    const RigCalibration found =
        calibrate_rig(views, {setup.rig.camera.width, setup.rig.camera.height},
                      {setup.rig.projector.width, setup.rig.projector.height});
    const Score s = score(setup.rig, found.rig, nearest, farthest);
    fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.4f} % | {:.4f} % | {:.2f} |\n", setup.name, seed,
               found.camera_rms, found.projector_rms, 100 * s.error, 100 * found.depth_deviation,
               s.ratio);
  }
}

}  // namespace
}  // namespace palpate::sensing

int main(int argc, char** argv) {
  fmt::print(
      "| rig | seed | camera px | projector px | median error | predicted | error / sigma |\n"
      "|---|---|---|---|---|---|---|\n");
  for (int i = 1; i < argc; ++i) palpate::sensing::run(static_cast<unsigned>(std::stoul(argv[i])));
}
