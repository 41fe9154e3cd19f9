// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Accuracy of calibrations of simulated rigs from simulated boards, for docs/calibration.md: errors
// of depths at the distances of the boards, and these errors over the deviations that the rig's
// covariance predicts. The errors of one calibration are correlated: they are one draw. So the fair
// test is the mean over many: of the squared ratio of depths, and of the squared Mahalanobis
// distance of the parameters, which is chi-square distributed with as many degrees of freedom.
// `calibration_trade 1 2` makes the table for the seeds 1 and 2.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "palpate/core/quantile.h"
#include "palpate/sensing/board_views.h"
#include "palpate/sensing/gray_code.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/virtual_sensor.h"
#include "setup/rig_jacobian.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

constexpr int kColumns = 9;  // inner corners of the board
constexpr int kRows = 6;
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
  double square = 25;   ///< [mm] of the board

  [[nodiscard]] Board board() const {
    return {.columns = kColumns, .rows = kRows, .square = square};
  }
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

/// Six shapes of rig: projector below and converging, a long sideways baseline, and wide angles
/// side by side; then three that served nothing while calibration was written: long lenses with a
/// diagonal baseline, a projector that is rolled and stands on the other side, and a small close
/// one. The seed varies focal lengths, principal points and the baseline.
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
  Setup tele{"long lenses, diagonal baseline", below.rig, 1200};
  tele.rig.camera.fx = tele.rig.camera.fy = 1700;
  tele.rig.camera.distortion = {-0.25, 0.4, 0.0004, 0.0007};
  tele.rig.projector = {.width = 1024, .height = 768, .fx = 2300, .fy = 2300, .cx = 515, .cy = 380};
  tele.rig.projector.distortion = {-0.08, 0.1, 0.0002, -0.0003};
  aim(tele.rig, {-170, 160, 30}, 1250);
  Setup rolled{"projector rolled, other side", below.rig, 540};
  rolled.rig.camera.fx = rolled.rig.camera.fy = 700;
  rolled.rig.camera.distortion = {-0.15, 0.09, -0.0007, 0.0003};
  rolled.rig.projector = {.width = 854, .height = 480, .fx = 900, .fy = 900, .cx = 430, .cy = 250};
  rolled.rig.projector.distortion = {0.05, -0.06, 0.0006, 0.0002};
  aim(rolled.rig, {-40, -190, -30}, 560);
  rolled.rig.T_projector_camera.prerotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  Setup close{"close, small board", below.rig, 230, 9};
  close.rig.camera.fx = close.rig.camera.fy = 900;
  close.rig.camera.distortion = {-0.06, 0.1, -0.0003, -0.0009};
  close.rig.projector = {.width = 640, .height = 360, .fx = 1000, .fy = 1000, .cx = 325, .cy = 190};
  close.rig.projector.distortion = {-0.1, 0.08, -0.0002, 0.0006};
  aim(close.rig, {70, 40, 0}, 240);
  std::vector<Setup> all{below, aside, wide, tele, rolled, close};
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
    pose.translate(
        Eigen::Vector3d(-(kColumns - 1) * setup.square / 2, -(kRows - 1) * setup.square / 2, 0));
    result.push_back(pose);
  }
  return result;
}

Body board_at(const Eigen::Isometry3d& T_camera_board, double square) {
  constexpr int kPixels = 60;  // of the print, a square
  constexpr int kAround = 1;   // squares of margin
  cv::Mat print((kRows + 1 + 2 * kAround) * kPixels, (kColumns + 1 + 2 * kAround) * kPixels, CV_8U,
                cv::Scalar(230));
  for (int row = 0; row <= kRows; ++row) {
    for (int column = row % 2; column <= kColumns; column += 2)
      print(cv::Rect((column + kAround) * kPixels, (row + kAround) * kPixels, kPixels, kPixels)) =
          20;
  }
  const double left = -(1 + kAround) * square;
  const double right = (kColumns + kAround) * square;
  const double bottom = (kRows + kAround) * square;
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

RigView photographed(const Setup& setup, const Eigen::Isometry3d& pose, unsigned seed) {
  const Rig& rig = setup.rig;
  const ImageSize panel{rig.projector.width, rig.projector.height};
  std::vector<cv::Mat> panels = draw_gray_code(panel);
  panels.insert(panels.begin(), panels[panels.size() - 2]);  // white sets the exposure
  const VirtualSensor sensor{.projector_blur_px = 0.5,
                             .ambient = 0.05,
                             .samples_per_axis = 3,
                             .exposure_steps = 1,
                             .seed = seed};
  const std::vector<Body> bodies{board_at(pose, setup.square)};
  Simulation simulation = simulate(rig, bodies, panels, sensor);
  simulation.frames.erase(simulation.frames.begin());
  for (cv::Mat& frame : simulation.frames) cv::cvtColor(frame, frame, cv::COLOR_BGR2GRAY);
  return view_from_gray_code(simulation.frames, setup.board(), panel);
}

struct Score {
  double error = 0;  ///< median, as a share of the depth
  double ratio = 0;  ///< RMS of the errors over their predicted deviations
  /// Squared Mahalanobis distance of the parameters, a degree of freedom; 1 is expected.
  double chi_square = 0;
};

/// The parameters of `found` less those of `truth`, in the order of `RigCovariance`.
Eigen::Matrix<double, kRigParameters, 1> difference(const Rig& found, const Rig& truth) {
  const auto lens = [](const geometry::Camera& c) {
    Eigen::Matrix<double, 9, 1> values;
    values << c.fx, c.fy, c.cx, c.cy, c.distortion[0], c.distortion[1], c.distortion[2],
        c.distortion[3], c.distortion[4];
    return values;
  };
  const Eigen::AngleAxisd turn(found.T_projector_camera.linear() *
                               truth.T_projector_camera.linear().transpose());
  Eigen::Matrix<double, kRigParameters, 1> all;
  all << lens(found.camera) - lens(truth.camera), lens(found.projector) - lens(truth.projector),
      turn.angle() * turn.axis(),
      found.T_projector_camera.translation() - truth.T_projector_camera.translation();
  return all;
}

double chi_square(const Rig& truth, const Rig& found) {
  const Eigen::Matrix<double, kRigParameters, 1> miss = difference(found, truth);
  // The estimated parameters, scaled to a deviation of 1: they are of very different size.
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < kRigParameters; ++i)
    if ((*found.covariance)(i, i) > 0) free.push_back(i);
  const Eigen::MatrixXd covariance = (*found.covariance)(free, free);
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.cwiseProduct(miss(free));
  return scaled.dot(correlation.ldlt().solve(scaled)) / static_cast<double>(free.size());
}

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
  return {median(errors), std::sqrt(squares / count), chi_square(truth, found)};
}

/// Sums over the seeds of one shape.
struct Sums {
  std::vector<double> errors;
  double squares = 0;  ///< of the ratios
  double chi_square = 0;
};

void run(unsigned seed, std::map<std::string, Sums>& sums) {
  for (const Setup& setup : setups(seed)) {
    std::vector<RigView> views;
    double nearest = 1e9, farthest = 0;
    for (const Eigen::Isometry3d& pose : poses(setup, seed)) {
      views.push_back(photographed(setup, pose, 100 * seed + static_cast<unsigned>(views.size())));
      views.back().name = fmt::format("pose {}", views.size());
      nearest = std::min(nearest, pose.translation().z());
      farthest = std::max(farthest, pose.translation().z());
    }
    const RigCalibration found =
        calibrate_rig(views, {setup.rig.camera.width, setup.rig.camera.height},
                      {setup.rig.projector.width, setup.rig.projector.height});
    const Score s = score(setup.rig, found.rig, nearest, farthest);
    fmt::print("| {} | {} | {:.4f} | {:.4f} | {:.4f} % | {:.4f} % | {:.2f} | {:.2f} |\n",
               setup.name, seed, found.camera_rms, found.projector_rms, 100 * s.error,
               100 * found.depth_deviation, s.ratio, s.chi_square);
    std::fflush(stdout);
    Sums& sum = sums[setup.name];
    sum.errors.push_back(s.error);
    sum.squares += s.ratio * s.ratio;
    sum.chi_square += s.chi_square;
  }
}

}  // namespace
}  // namespace palpate::sensing

int main(int argc, char** argv) {
  fmt::print(
      "| rig | seed | camera px | projector px | median error | predicted | error / sigma | "
      "chi-square |\n|---|---|---|---|---|---|---|---|\n");
  std::map<std::string, palpate::sensing::Sums> sums;
  for (int i = 1; i < argc; ++i)
    palpate::sensing::run(static_cast<unsigned>(std::stoul(argv[i])), sums);
  fmt::print(
      "\n| rig | calibrations | median of the median errors | largest | error / sigma (RMS) | "
      "chi-square (mean) |\n|---|---|---|---|---|---|\n");
  for (const auto& [name, sum] : sums) {
    const auto count = static_cast<double>(sum.errors.size());
    fmt::print("| {} | {} | {:.4f} % | {:.4f} % | {:.2f} | {:.2f} |\n", name, sum.errors.size(),
               100 * palpate::median(sum.errors),
               100 * *std::max_element(sum.errors.begin(), sum.errors.end()),
               std::sqrt(sum.squares / count), sum.chi_square / count);
  }
}
