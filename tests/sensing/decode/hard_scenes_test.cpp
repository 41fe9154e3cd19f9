// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <tuple>

#include "palpate/sensing/decode.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// Share of the reconstructed pixels that may be off by a period.
constexpr double kMostOff = 0.01;

constexpr double kWall = 720;
constexpr double kPatternPeriod = 20;

struct Count {
  long reconstructed = 0;
  long off = 0;  ///< by more than half a period
};

/// Projector pixel along the sinusoid.
double panel_pixel(const Rig& rig, int v, int u, double z) {
  const Eigen::Vector2d ray = geometry::undistort(rig.camera, {u, v});
  const Eigen::Vector3d point = rig.T_projector_camera * (z * ray.homogeneous());
  return geometry::distort(rig.projector, point.hnormalized()).y();
}

Count count_off(const Rig& rig, const geometry::ImageF& z, const geometry::ImageF& truth,
                const cv::Rect& where) {
  Count count;
  for (int v = where.y; v < where.y + where.height; ++v) {
    for (int u = where.x; u < where.x + where.width; ++u) {
      if (!(z(v, u) > 0)) continue;
      ++count.reconstructed;
      const double error = panel_pixel(rig, v, u, static_cast<double>(z(v, u))) -
                           panel_pixel(rig, v, u, static_cast<double>(truth(v, u)));
      if (!(std::abs(error) <= kPatternPeriod / 2)) ++count.off;
    }
  }
  return count;
}

/// Depth of a plane parallel to the wall, in front of it by `periods` of the sinusoid.
double in_front_by(const Rig& rig, double periods) {
  const double wanted = panel_pixel(rig, 120, 160, kWall);
  double near = kWall / 3;
  double far = kWall;
  const double sign = panel_pixel(rig, 120, 160, near) > wanted ? 1 : -1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (near + far) / 2;
    const double apart = sign * (panel_pixel(rig, 120, 160, middle) - wanted);
    (apart > periods * kPatternPeriod ? near : far) = middle;
  }
  return near;
}

/// A rectangle of half widths `half` [mm] in front of the wall.
Surface plate(double z, const Eigen::Vector2d& half) {
  return [=](const Eigen::Vector2d& ray) {
    const bool hit = std::abs(ray.x() * z) < half.x() && std::abs(ray.y() * z) < half.y();
    return hit ? z : kWall;
  };
}

/// The object keeps only the share `rest` of the green and the blue light.
void redden(cv::Mat& frame, const geometry::ImageF& truth, double rest) {
  for (int v = 0; v < frame.rows; ++v) {
    for (int u = 0; u < frame.cols; ++u) {
      if (!(truth(v, u) < 0.999F * static_cast<float>(kWall))) continue;
      auto& pixel = frame.at<cv::Vec<ushort, 3>>(v, u);
      for (const int channel : {0, 1})
        pixel[channel] = cv::saturate_cast<ushort>(pixel[channel] * rest);
    }
  }
}

const cv::Rect kEverywhere(0, 0, 320, 240);

TEST(HardScenes, AnObjectInFrontOfTheWallByNearlyWholePeriodsIsNotOffByOne) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, kPatternPeriod, 1024);
  for (const Segmentation segmentation : {Segmentation::flood, Segmentation::snakes}) {
    const Decoder decoder(rig, pattern, ideal_colors(), {.segmentation = segmentation});
    for (const double periods : {1.0, 2.0, 2.97, 3.0, 3.03}) {
      const Scene scene = render(rig, pattern, plate(in_front_by(rig, periods), {60, 45}));
      const Count count = count_off(rig, decoder.decode(scene.frame).range.z, scene.z, kEverywhere);
      EXPECT_GT(count.reconstructed, 30000) << periods;
      EXPECT_LE(static_cast<double>(count.off), kMostOff * static_cast<double>(count.reconstructed))
          << periods << (segmentation == Segmentation::flood ? " flood" : " snakes");
    }
  }
}

TEST(HardScenes, AnObjectWhoseColoursCannotBeReadLosesPixelsInsteadOfBeingWrong) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, kPatternPeriod, 1024);
  const Decoder decoder(rig, pattern, ideal_colors());
  for (const double rest : {0.0, 0.03, 0.2, 0.5}) {
    for (const double periods : {1.0, 2.0, 2.5, 3.0}) {
      Scene scene = render(rig, pattern, plate(in_front_by(rig, periods), {60, 45}));
      redden(scene.frame, scene.z, rest);
      const Count count = count_off(rig, decoder.decode(scene.frame).range.z, scene.z, kEverywhere);
      EXPECT_LE(static_cast<double>(count.off), kMostOff * static_cast<double>(count.reconstructed))
          << rest << ' ' << periods;
    }
  }
}

TEST(HardScenes, AnObjectSmallerThanAStripeIsNotOffByAPeriod) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, kPatternPeriod, 1024);
  const Decoder decoder(rig, pattern, ideal_colors());
  for (const double half : {4.0, 6.0, 9.0}) {
    const Scene scene = render(rig, pattern, plate(in_front_by(rig, 2), {half, 30}));
    const Count count = count_off(rig, decoder.decode(scene.frame).range.z, scene.z, kEverywhere);
    EXPECT_LE(static_cast<double>(count.off), kMostOff * static_cast<double>(count.reconstructed))
        << half;
  }
}

}  // namespace
}  // namespace palpate::sensing
