// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// Depth along the camera ray (x, y, 1); NaN where it hits nothing.
using Surface = std::function<double(const Eigen::Vector2d& ray)>;

/// The plane normal . X = distance.
inline Surface plane(const Eigen::Vector3d& normal, double distance) {
  return [=](const Eigen::Vector2d& ray) { return distance / normal.dot(ray.homogeneous()); };
}

/// The front of a sphere.
inline Surface sphere(const Eigen::Vector3d& center, double radius) {
  return [=](const Eigen::Vector2d& ray) {
    const Eigen::Vector3d d = ray.homogeneous();
    const double b = d.dot(center) / d.squaredNorm();
    const double c = (center.squaredNorm() - radius * radius) / d.squaredNorm();
    return b - std::sqrt(b * b - c);  // NaN beside it
  };
}

/// The nearer of two surfaces.
inline Surface nearer(const Surface& a, const Surface& b) {
  return [=](const Eigen::Vector2d& ray) { return std::fmin(a(ray), b(ray)); };
}

/// A camera and a projector beside and above it, at an angle if `verging`.
inline Rig make_rig(bool verging) {
  Rig rig;
  rig.camera = {.width = 320, .height = 240, .fx = 550, .fy = 550, .cx = 159.5, .cy = 119.5};
  rig.projector = {.width = 1024, .height = 768, .fx = 1500, .fy = 1500, .cx = 200, .cy = 40};
  rig.T_projector_camera.translation() = Eigen::Vector3d(150, 165, -20);
  if (verging) {
    rig.projector.cx = 511.5;
    rig.projector.cy = 383.5;
    rig.T_projector_camera.linear() = (Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()) *
                                       Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()) *
                                       Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitZ()))
                                          .toRotationMatrix();
    rig.T_projector_camera.translation() =
        rig.T_projector_camera.linear() * Eigen::Vector3d(150, 165, -20);
  }
  return rig;
}

/// Six colours in 31 stripes, all ordered pairs once, over `length` projector pixels.
inline Pattern make_pattern(Axis axis, double period, double length) {
  Pattern pattern{.axis = axis, .period = period, .phase = 0.7, .mean = 0.575, .amplitude = 0.425};
  pattern.colors = {{"R", {1, 0, 0}}, {"Y", {1, 1, 0}}, {"G", {0, 1, 0}},
                    {"C", {0, 1, 1}}, {"B", {0, 0, 1}}, {"M", {1, 0, 1}}};
  pattern.stripes = {0, 5, 4, 0, 4, 3, 0, 2, 5, 2, 3, 1, 3, 2, 0, 3,
                     4, 1, 0, 1, 5, 1, 4, 2, 1, 2, 4, 5, 3, 5, 0};
  for (std::size_t i = 1; i < pattern.stripes.size(); ++i) {
    pattern.stripe_edges.push_back(length * static_cast<double>(i) / 31 - 0.5);
  }
  return pattern;
}

/// Hues as a perfect camera sees them.
inline TrainedColors ideal_colors() {
  TrainedColors colors;
  const char* const names[] = {"R", "Y", "G", "C", "B", "M"};
  for (int i = 0; i < 6; ++i) {
    colors.colors.push_back({names[i], i * std::numbers::pi / 3, 0.01, 1000});
  }
  return colors;
}

struct Scene {
  cv::Mat frame;       ///< 16 bit BGR
  geometry::ImageF z;  ///< truth
};

/// The camera's view: ray by ray and channel by channel, with nothing of the decoder's code.
/// `ambient` and the surface's reflectance are fractions of full scale.
inline Scene render(const Rig& rig, const Pattern& pattern, const Surface& surface,
                    double ambient = 0.02, double reflectance = 0.8) {
  const geometry::Camera& camera = rig.camera;
  Scene scene{cv::Mat(camera.height, camera.width, CV_16UC3),
              geometry::ImageF(camera.height, camera.width)};
  const ChromaticShift shifts[] = {rig.blue, ChromaticShift{}, rig.red};  // BGR
  const int axis = pattern.axis == Axis::x ? 0 : 1;
  const auto light = [&](int channel, const Eigen::Vector2d& ray) {
    const double z = surface(ray);
    const Eigen::Vector3d point = rig.T_projector_camera * (z * ray.homogeneous());
    if (!(point.z() > 0)) return 0.0;
    Eigen::Vector2d pixel = geometry::distort(rig.projector, point.hnormalized());
    if (pixel.x() < -0.5 || pixel.y() < -0.5 || pixel.x() > rig.projector.width - 0.5 ||
        pixel.y() > rig.projector.height - 0.5) {
      return 0.0;
    }
    const double focal = axis == 0 ? rig.projector.fx : rig.projector.fy;
    const double center = axis == 0 ? rig.projector.cx : rig.projector.cy;
    const double direction = (pixel[axis] - center) / focal;
    pixel[axis] = focal * (direction - shifts[channel].gamma) / shifts[channel].beta + center;
    std::size_t stripe = 0;
    while (stripe < pattern.stripe_edges.size() && pixel[1 - axis] > pattern.stripe_edges[stripe])
      ++stripe;
    const double color =
        pattern.colors.empty()
            ? 1.0
            : pattern.colors[static_cast<std::size_t>(pattern.stripes[stripe])].rgb[2 - channel];
    return color * (pattern.mean + pattern.amplitude * std::cos(2 * std::numbers::pi * pixel[axis] /
                                                                    pattern.period +
                                                                pattern.phase));
  };
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d ray = geometry::undistort(camera, {u, v});
      scene.z(v, u) = static_cast<float>(surface(ray));
      for (int channel = 0; channel < 3; ++channel) {
        const double value = ambient + reflectance * light(channel, shifts[channel].alpha * ray);
        scene.frame.at<cv::Vec<ushort, 3>>(v, u)[channel] =
            static_cast<ushort>(std::lround(65535 * std::fmin(value, 1)));
      }
    }
  }
  return scene;
}

/// Adds normal noise of one standard deviation everywhere [fraction of full scale].
inline void add_noise(cv::Mat& frame, double deviation, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0, deviation);
  for (auto& pixel : cv::Mat_<cv::Vec<ushort, 3>>(frame)) {
    for (int channel = 0; channel < 3; ++channel)
      pixel[channel] = cv::saturate_cast<ushort>(pixel[channel] + 65535 * normal(generator));
  }
}

}  // namespace palpate::sensing
