// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/virtual_sensor.h"
#include "test_files.h"

/// The virtual sensor against an independent path tracer, which rendered the bundled frames.
namespace palpate::sensing {
namespace {

/// px; blocks over which the phase is measured: some three periods. The renderers differ in the
/// light beyond the border of the image.
constexpr int kBlock = 24, kMargin = 8;

/// Frames of the path tracer and the virtual sensor of the same scene, and its true range map.
struct Pair {
  cv::Mat rendered, simulated;
  geometry::ImageF z;
  cv::Mat rendered_lit;
  PixelMask lit;
  Rig rig;
};

Pair frames_of(const std::string& name) {
  Pair pair;
  pair.rig = read_rig(demo_path("rig.yaml"));
  pair.rendered = read_frame(demo_path("frames/" + name + ".png"));
  pair.rendered_lit = read_frame(demo_path("truth/" + name + "_lit.png"));
  pair.z = geometry::read_depth_tiff(demo_path("truth/" + name + ".tiff"));
  const std::vector<Body> bodies = {
      {.mesh = geometry::mesh_range_map({pair.z, pair.rig.camera}).mesh}};
  const std::vector<cv::Mat> panels = {read_frame(demo_path("pattern.png"))};
  Simulation simulation = simulate(pair.rig, bodies, panels, {});
  pair.simulated = simulation.frames[0];
  pair.lit = simulation.truth.lit;
  return pair;
}

const Pair& duck() {
  static const Pair the_duck = frames_of("duck");
  return the_duck;
}

/// The amplitude of the pattern's sinusoid in a block, relative to where the truth has it: its
/// argument is the error of the phase.
std::complex<double> response(const cv::Mat& frame, const Pair& pair, int top, int left) {
  const Eigen::Isometry3d& T = pair.rig.T_projector_camera;
  std::complex<double> sum = 0;
  for (int u = left; u < left + kBlock; ++u) {
    std::complex<double> column = 0, carriers = 0;
    double mean = 0;
    for (int v = top; v < top + kBlock; ++v) {
      const Eigen::Vector3d ray = geometry::undistort(pair.rig.camera, {u, v}).homogeneous();
      const Eigen::Vector2d place = (T * (pair.z(v, u) * ray)).hnormalized();
      const double phase =
          2 * std::numbers::pi * geometry::distort(pair.rig.projector, place).y() / 10;
      const auto& pixel = frame.at<cv::Vec3b>(v, u);
      const double light = pixel[0] + pixel[1] + pixel[2];
      column += light * std::polar(1.0, -phase);
      carriers += std::polar(1.0, -phase);
      mean += light / kBlock;
    }
    sum += column - mean * carriers;
  }
  return sum;
}

/// Returns true if a block is lit, smooth and not saturated.
bool fit(const Pair& pair, int top, int left) {
  for (int v = top; v < top + kBlock; ++v) {
    for (int u = left; u < left + kBlock; ++u) {
      const auto& a = pair.rendered.at<cv::Vec3b>(v, u);
      const auto& b = pair.simulated.at<cv::Vec3b>(v, u);
      if (!pair.lit(v, u) || pair.rendered_lit.at<uchar>(v, u) == 0 || !(pair.z(v, u) > 0) ||
          std::max({a[0], a[1], a[2], b[0], b[1], b[2]}) == 255 ||
          (v > top && !(std::abs(pair.z(v, u) - pair.z(v - 1, u)) < 2)) ||
          (u > left && !(std::abs(pair.z(v, u) - pair.z(v, u - 1)) < 2))) {
        return false;
      }
    }
  }
  return true;
}

/// [rad] simulated minus rendered phase, block by block.
geometry::ErrorStatistics phase_differences(const Pair& pair) {
  std::vector<double> differences;
  for (int top = kMargin; top + kBlock <= pair.z.rows() - kMargin; top += kBlock) {
    for (int left = kMargin; left + kBlock <= pair.z.cols() - kMargin; left += kBlock) {
      if (!fit(pair, top, left)) continue;
      differences.push_back(std::arg(response(pair.simulated, pair, top, left) /
                                     response(pair.rendered, pair, top, left)));
    }
  }
  return geometry::error_statistics(differences);
}

/// rad; the noise of both is some 0.005 of it.
constexpr double kSamePhase = 0.02;

TEST(VirtualSensorPeer, AgreesWithAPathTracerOnThePhaseOfAPlane) {
  const geometry::ErrorStatistics difference = phase_differences(frames_of("plane"));
  EXPECT_GT(difference.count, 400);
  EXPECT_LT(difference.rms, kSamePhase);
}

TEST(VirtualSensorPeer, AgreesWithAPathTracerOnThePhaseOfACurvedBody) {
  const geometry::ErrorStatistics difference = phase_differences(duck());
  EXPECT_GT(difference.count, 300);
  EXPECT_LT(difference.rms, kSamePhase);
}

TEST(VirtualSensorPeer, AgreesWithAPathTracerOnTheShadows) {
  const Pair& pair = duck();
  long differ = 0, lit = 0;
  for (int v = 0; v < pair.z.rows(); ++v) {
    for (int u = 0; u < pair.z.cols(); ++u) {
      const bool rendered_lit = pair.rendered_lit.at<uchar>(v, u) > 0;
      differ += rendered_lit != pair.lit(v, u);
      lit += rendered_lit;
    }
  }
  // The mesh has only the part of the duck that the camera sees, and is cut at its outline.
  EXPECT_LT(static_cast<double>(differ), 0.005 * static_cast<double>(lit));
}

}  // namespace
}  // namespace palpate::sensing
