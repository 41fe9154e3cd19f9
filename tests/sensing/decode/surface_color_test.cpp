// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Colours of surfaces under the pattern, from true depths.
#include "palpate/sensing/surface_color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "not_finite.h"
#include "palpate/core/error.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr double kColorAmbient = 0.02;
constexpr double kColorReflectance = 0.8;

/// The upper half of the camera of `make_rig`.
Rig low_rig() {
  Rig rig = make_rig(true);
  rig.camera.height = 120;
  return rig;
}

struct Painted {
  Rig rig = low_rig();
  Pattern pattern;
  cv::Mat frame;  ///< 16 bit
  cv::Mat truth;  ///< float: under white light of the sinusoid's mean
  geometry::RangeMap range;
};

/// A plane whose reflectance is multiplied by `paint` (float BGR), seen through a lens that blurs.
Painted painted(const cv::Mat& paint, bool stripes, Axis axis = Axis::y) {
  Painted scene;
  scene.pattern = make_pattern(axis, 20, axis == Axis::y ? 1024 : 768);
  if (!stripes) {
    scene.pattern.colors.clear();
    scene.pattern.stripes.clear();
    scene.pattern.stripe_edges.clear();
  }
  const Scene seen =
      render(scene.rig, scene.pattern, plane({0.1, 0.1, 1}, 720), kColorAmbient, kColorReflectance);
  seen.frame.convertTo(scene.frame, CV_32F);
  cv::multiply(scene.frame, paint, scene.frame);
  cv::GaussianBlur(scene.frame, scene.frame, {}, 0.8);
  scene.frame.convertTo(scene.frame, CV_16U);
  cv::GaussianBlur(paint, scene.truth, {}, 0.8);
  scene.truth *= kColorAmbient + kColorReflectance * scene.pattern.mean;
  scene.range = {.z = seen.z, .camera = scene.rig.camera};
  // Beyond the panel there is no depth.
  for (int v = 0; v < paint.rows; ++v) {
    for (int u = 0; u < paint.cols; ++u) {
      const Eigen::Vector2d ray = geometry::undistort(scene.rig.camera, {u, v});
      const auto z = static_cast<double>(seen.z(v, u));
      const Eigen::Vector3d point = scene.rig.T_projector_camera * (z * ray.homogeneous());
      const Eigen::Vector2d pixel = geometry::distort(scene.rig.projector, point.hnormalized());
      if (!(pixel.x() > 0 && pixel.y() > 0 && pixel.x() < 1023 && pixel.y() < 767))
        scene.range.z(v, u) = kFloatNaN;
    }
  }
  return scene;
}

struct Misfit {
  double rms = 0;  ///< relative to the mean of the truth
  long count = 0;
};

/// Farther than `margin` px from unknown depths and the image's border.
Misfit misfit(const Painted& scene, const cv::Mat& color, int margin) {
  cv::Mat known(color.size(), CV_8U);
  for (int v = 0; v < known.rows; ++v) {
    for (int u = 0; u < known.cols; ++u) {
      const bool inside = v > 0 && u > 0 && v + 1 < known.rows && u + 1 < known.cols;
      known.at<uchar>(v, u) = inside && scene.range.z(v, u) > 0 ? 1 : 0;
    }
  }
  cv::erode(known, known, cv::Mat(), {-1, -1}, margin, cv::BORDER_CONSTANT, cv::Scalar(0));
  Misfit result;
  double mean = 0;
  for (int v = 0; v < known.rows; ++v) {
    for (int u = 0; u < known.cols; ++u) {
      if (known.at<uchar>(v, u) == 0) continue;
      for (int channel = 0; channel < 3; ++channel) {
        const auto wanted = static_cast<double>(scene.truth.at<cv::Vec3f>(v, u)[channel]);
        const double error = static_cast<double>(color.at<cv::Vec3f>(v, u)[channel]) - wanted;
        result.rms += error * error;
        mean += wanted;
        ++result.count;
      }
    }
  }
  result.rms = std::sqrt(result.rms / static_cast<double>(result.count)) /
               (mean / static_cast<double>(result.count));
  return result;
}

cv::Mat find_color(const Painted& scene) {
  return surface_color(scene.frame, scene.range, scene.rig, scene.pattern);
}

TEST(SurfaceColor, OfAWhiteSurfaceHasNeitherStripesNorFringes) {
  const cv::Mat white(120, 320, CV_32FC3, cv::Scalar::all(1));
  for (const Axis axis : {Axis::y, Axis::x}) {
    for (const bool stripes : {false, true}) {
      if (axis == Axis::x && !stripes) continue;
      const Painted scene = painted(white, stripes, axis);
      const Misfit found = misfit(scene, find_color(scene), 8);
      ASSERT_GT(found.count, 30000);
      EXPECT_LT(found.rms, stripes ? 0.04 : 0.005) << stripes;
    }
  }
}

TEST(SurfaceColor, KeepsPaintThatVariesSmoothlyInColorAndSharplyInBrightness) {
  cv::Mat paint(120, 320, CV_32FC3);
  for (int v = 0; v < paint.rows; ++v) {
    for (int u = 0; u < paint.cols; ++u) {
      const float brightness = (u / 40 + v / 40) % 2 == 0 ? 1.0F : 0.5F;
      const float warm = static_cast<float>(u) / 320;
      paint.at<cv::Vec3f>(v, u) = brightness * cv::Vec3f(1 - 0.6F * warm, 0.7F, 0.4F + 0.6F * warm);
    }
  }
  const Painted scene = painted(paint, true);
  EXPECT_LT(misfit(scene, find_color(scene), 8).rms, 0.1);
  // The frame itself, with its stripes, is far from that.
  cv::Mat raw;
  scene.frame.convertTo(raw, CV_32F, 1.0 / 65535);
  EXPECT_GT(misfit(scene, raw, 8).rms, 0.5);
}

TEST(SurfaceColor, IsBlackWithoutADepthAndRefusesOtherSizes) {
  Painted scene = painted(cv::Mat(120, 320, CV_32FC3, cv::Scalar::all(1)), true);
  scene.range.z.block(50, 100, 20, 30).setConstant(kFloatNaN);
  const cv::Mat color = find_color(scene);
  EXPECT_EQ(cv::norm(color(cv::Rect(100, 50, 30, 20)), cv::NORM_INF), 0);
  scene.frame = scene.frame.rowRange(0, 60);
  EXPECT_THROW((void)find_color(scene), InvalidInput);
}

TEST(SurfaceColor, IsCodedForScreens) {
  // Values of the standard (IEC 61966-2-1).
  const cv::Mat linear = (cv::Mat_<float>(1, 5) << 0, 0.002F, 0.2140F, 1, kFloatNaN);
  const cv::Mat coded = srgb_of(linear);
  EXPECT_EQ(coded.at<uchar>(0, 0), 0);
  EXPECT_EQ(coded.at<uchar>(0, 1), 7);
  EXPECT_EQ(coded.at<uchar>(0, 2), 127);
  EXPECT_EQ(coded.at<uchar>(0, 3), 255);
  EXPECT_EQ(coded.at<uchar>(0, 4), 0);
}

}  // namespace
}  // namespace palpate::sensing
