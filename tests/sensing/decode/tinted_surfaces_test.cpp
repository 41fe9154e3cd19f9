// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/tinted_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "palpate/sensing/decode.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// A right depth is this close, relative to the distance; a period away is 2 %.
constexpr double kRight = 0.003;

struct Paint {
  const char* name;
  Eigen::Vector3d rgb;
};
const Paint kPaints[] = {{"red", {1, 0.05, 0.05}},         {"pure red", {1, 0, 0}},
                         {"pure green", {0, 1, 0}},        {"blue", {0.05, 0.05, 1}},
                         {"dark red", {0.35, 0.01, 0.01}}, {"orange", {1, 0.3, 0.04}},
                         {"skin", {1, 0.6, 0.5}}};

constexpr double kTestPeriod = 10;

/// A camera that sees stripes 24 px wide.
Rig close_rig() {
  Rig rig = make_rig(false);
  rig.camera.fx = rig.camera.fy = 1100;
  return rig;
}

/// Paints surfaces nearer than `behind`; adds noise as of an 8-bit camera.
Scene painted(const Rig& rig, const Pattern& pattern, const Surface& surface, double behind,
              const Eigen::Vector3d& rgb) {
  Scene scene = render(rig, pattern, surface, 0.0);
  for (int v = 0; v < scene.frame.rows; ++v) {
    for (int u = 0; u < scene.frame.cols; ++u) {
      if (!(scene.z(v, u) < static_cast<float>(behind))) continue;
      auto& pixel = scene.frame.at<cv::Vec<ushort, 3>>(v, u);
      for (int c = 0; c < 3; ++c) {
        pixel[c] = cv::saturate_cast<ushort>(pixel[c] * rgb[2 - c]);
      }
    }
  }
  add_noise(scene.frame, 0.002, 7);
  return scene;
}

struct Figures {
  long lit = 0;    ///< pixels whose stripe the paint reflects, away from the image's border
  long found = 0;  ///< of these, with a depth
  long wrong = 0;
};

Figures measure(const Rig& rig, const Pattern& pattern, const Scene& scene, double behind,
                const Eigen::Vector3d& rgb) {
  const DecodeResult result = Decoder(rig, pattern, ideal_colors()).decode(scene.frame);
  constexpr int kBorder = 8;
  constexpr int kEdge = 3;
  Figures figures;
  for (int v = kBorder; v < scene.frame.rows - kBorder; ++v) {
    for (int u = kBorder; u < scene.frame.cols - kBorder; ++u) {
      const auto truth = static_cast<double>(scene.z(v, u));
      if (!(truth < behind)) continue;
      const Eigen::Vector2d ray = geometry::undistort(rig.camera, {u, v});
      const Eigen::Vector3d point = rig.T_projector_camera * (truth * ray.homogeneous());
      const double x = geometry::distort(rig.projector, point.hnormalized()).x();
      const auto stripe = static_cast<std::size_t>(
          std::upper_bound(pattern.stripe_edges.begin(), pattern.stripe_edges.end(), x) -
          pattern.stripe_edges.begin());
      const auto& color = pattern.colors[static_cast<std::size_t>(pattern.stripes[stripe])].rgb;
      const double z = static_cast<double>(result.range.z(v, u));
      if (color.cwiseProduct(rgb).maxCoeff() > 0.2 * rgb.maxCoeff()) {
        ++figures.lit;
        figures.found += z > 0 ? 1 : 0;
      }
      // The camera sees both sides of an edge in the pixels beside it.
      const bool inside = scene.z(v, u - kEdge) < static_cast<float>(behind) &&
                          scene.z(v, u + kEdge) < static_cast<float>(behind);
      figures.wrong += inside && std::abs(z - truth) > kRight * truth ? 1 : 0;
    }
  }
  return figures;
}

/// \param painted_to, measured_to [mm] nearer surfaces are painted, and measured.
void expect_measured(const Surface& surface, double painted_to, double measured_to,
                     double coverage) {
  const Rig rig = close_rig();
  const Pattern pattern = make_pattern(Axis::y, kTestPeriod, 1024);
  for (const Paint& paint : kPaints) {
    const Figures figures =
        measure(rig, pattern, painted(rig, pattern, surface, painted_to, paint.rgb), measured_to,
                paint.rgb);
    EXPECT_GT(figures.lit, 5000) << paint.name;
    EXPECT_GE(static_cast<double>(figures.found), coverage * static_cast<double>(figures.lit))
        << paint.name;
    EXPECT_LE(static_cast<double>(figures.wrong), 0.005 * static_cast<double>(figures.found))
        << paint.name;
  }
}

TEST(TintedSurfaces, APaintedWallHasDepthsWhereverItReflectsTheStripes) {
  expect_measured(plane({0.2, -0.1, 1}, 720), 1e9, 1e9, 0.9);
}

TEST(TintedSurfaces, APaintedBallBeforeAWhiteWallHasDepths) {
  // Measured where the camera sees it at less than 65 degrees.
  expect_measured(nearer(sphere({0, 0, 780}, 75), plane({0, 0, 1}, 900)), 850, 748, 0.65);
}

TEST(TintedSurfaces, APurelyRedStripThatIsToldFromTheWallIsNotOffByPeriods) {
  // Too narrow for its light and dark stripes to tell the period: no depth is right as well. At
  // depths such as 600, where its phase goes on in the wall's, the strip would be one region with
  // it and get the wall's depths, of whichever colour it is.
  const Rig rig = close_rig();
  const Pattern pattern = make_pattern(Axis::y, kTestPeriod, 1024);
  for (const double z : {560.0, 640.0, 680.0}) {
    for (const double half : {15.0, 30.0, 50.0}) {
      const Surface strip = [=](const Eigen::Vector2d& ray) {
        return std::abs(ray.x() * z) < half ? z : 800.0;
      };
      const Scene scene = painted(rig, pattern, strip, 799, {1, 0, 0});
      const Figures figures = measure(rig, pattern, scene, 799, {1, 0, 0});
      EXPECT_LE(figures.wrong, figures.lit / 200) << z << ' ' << half;
    }
  }
}

TEST(TintedSurfaces, AWhiteSurfaceInLightOfOneColourHasNoCodeAndNoDepth) {
  // All stripes are as bright as the others in red, as with a pattern of one colour.
  const Rig rig = make_rig(false);
  Pattern seen = make_pattern(Axis::y, kTestPeriod, 1024);
  for (PatternColor& color : seen.colors) color.rgb = {1, 0, 0};
  const Scene scene = render(rig, seen, plane({0, 0, 1}, 700), 0.0);
  const Pattern pattern = make_pattern(Axis::y, kTestPeriod, 1024);
  const DecodeResult result = Decoder(rig, pattern, ideal_colors()).decode(scene.frame);
  EXPECT_EQ((result.range.z > 0).count(), 0);
}

}  // namespace
}  // namespace palpate::sensing
