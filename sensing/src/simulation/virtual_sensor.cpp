// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/virtual_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "image/gaussian_blur.h"
#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "simulation/camera_electronics.h"
#include "simulation/light_path.h"
#include "simulation/projector_panel.h"
#include "simulation/virtual_scene.h"

namespace palpate::sensing {
namespace {

/// Smallest size of a mosaic for bilinear interpolation, in pixels along each axis.
constexpr int kSmallestMosaic = 3;

/// The surface that a ray of one colour meets, and its light, independently of the panel.
struct Echo {
  Eigen::Vector3d reflectance{0, 0, 0};  ///< blue, green, red
  Illumination light;
};

/// Light that one colour of a camera pixel's sample receives: `white` times the panel's light at
/// `panel`, and `dark` without it.
struct TracedRay {
  int column = 0;
  int channel = 0;
  std::optional<Eigen::Vector2d> panel;  ///< px; none in the shade
  double white = 0;
  double dark = 0;
};

struct Renderer {
  const geometry::Camera& camera;
  const VirtualSensor& sensor;
  const LightPath& path;
  std::array<ChromaticShift, 3> shifts;  ///< blue, green, red
  std::vector<cv::Mat> lights;           ///< of the panels

  [[nodiscard]] std::optional<Echo> follow(const VirtualScene& scene,
                                           const Eigen::Vector2d& ray) const {
    const auto place = scene.look(ray.homogeneous());
    if (!place) return std::nullopt;
    return Echo{.reflectance = scene.reflectance(*place).reverse(),
                .light = path.illuminate(scene, *place)};
  }

  /// Light that one colour of an echo sends to a pixel in each image.
  [[nodiscard]] TracedRay ray_of(const Echo& echo, int channel, int column) const {
    const auto panel =
        echo.light.lit ? path.shifted(echo.light.pixel, shifts[static_cast<std::size_t>(channel)])
                       : std::nullopt;
    return {.column = column,
            .channel = channel,
            .panel = panel,
            .white = echo.reflectance[channel] * echo.light.diffuse + echo.light.highlight,
            .dark = echo.reflectance[channel] * sensor.ambient};
  }

  /// The rays that end in a row of the camera, pixel by pixel.
  void trace_row(const VirtualScene& scene, int v, std::vector<TracedRay>& rays) const {
    const int samples = sensor.samples_per_axis;
    const auto offset = [samples](int i) { return (i + 0.5) / samples - 0.5; };
    rays.clear();
    for (int u = 0; u < camera.width; ++u) {
      for (int s = 0; s < samples * samples; ++s) {
        const Eigen::Vector2d ray = geometry::undistort(
            camera, Eigen::Vector2d(u + offset(s % samples), v + offset(s / samples)));
        std::optional<Echo> echo;
        for (std::size_t c = 0; c < 3; ++c) {
          // Colours with the same path are traced once.
          if (c == 0 || shifts[c].alpha != shifts[c - 1].alpha) {
            echo = follow(scene, shifts[c].alpha * ray);
          }
          if (echo) rays.push_back(ray_of(*echo, static_cast<int>(c), u));
        }
      }
    }
  }

  /// Adds `weight` times the light at one time to each image.
  void add_moment(const VirtualScene& scene, float weight, std::vector<cv::Mat>& images) const {
    const float share =
        weight / static_cast<float>(sensor.samples_per_axis * sensor.samples_per_axis);
    parallel_for(camera.height, [&](int v) {
      std::vector<TracedRay> rays;
      trace_row(scene, v, rays);
      // One panel after the other: all of them do not fit into the cache.
      for (std::size_t i = 0; i < images.size(); ++i) {
        auto* const row = images[i].ptr<cv::Vec3f>(v);
        for (const TracedRay& ray : rays) {
          const double light =
              ray.panel ? static_cast<double>(light_at(lights[i], *ray.panel, ray.channel)) : 0;
          row[ray.column][ray.channel] += share * static_cast<float>(ray.white * light + ray.dark);
        }
      }
    });
  }
};

/// At pixel centres, in green.
SceneTruth scene_truth(const VirtualScene& scene, const geometry::Camera& camera,
                       const LightPath& path) {
  const long rows = camera.height, columns = camera.width;
  SceneTruth truth{.range = {geometry::ImageF::Constant(rows, columns, kUnknown), camera},
                   .body = PixelLabels::Constant(rows, columns, -1),
                   .covered = PixelMask::Constant(rows, columns, false),
                   .lit = PixelMask::Constant(rows, columns, false),
                   .incidence = geometry::ImageF::Constant(rows, columns, kUnknown)};
  parallel_for(rows, [&](long v) {
    for (long u = 0; u < columns; ++u) {
      const Eigen::Vector2d pixel(static_cast<double>(u), static_cast<double>(v));
      const auto place = scene.look(geometry::undistort(camera, pixel).homogeneous());
      if (!place) continue;
      const Illumination light = path.illuminate(scene, *place);
      truth.range.z(v, u) = static_cast<float>(place->position.z());
      truth.body(v, u) = place->body;
      truth.covered(v, u) = light.covered;
      truth.lit(v, u) = light.lit;
      const double camera_incidence = std::atan2(place->facet.cross(place->position).norm(),
                                                 -place->facet.dot(place->position));
      truth.incidence(v, u) =
          static_cast<float>(std::max(camera_incidence, light.projector_incidence));
    }
  });
  return truth;
}

/// Light on the camera's chip before lens blur, one image per panel.
std::vector<cv::Mat> expose(const Renderer& renderer, VirtualScene& scene, std::size_t count) {
  std::vector<cv::Mat> images;
  for (std::size_t i = 0; i < count; ++i) {
    images.emplace_back(renderer.camera.height, renderer.camera.width, CV_32FC3,
                        cv::Scalar::all(0));
  }
  const int steps = scene.moves() ? renderer.sensor.exposure_steps : 1;
  for (int step = 0; step < steps; ++step) {
    if (scene.moves()) scene.move_to((step + 0.5) / steps);
    renderer.add_moment(scene, 1 / static_cast<float>(steps), images);
  }
  return images;
}

void check_input(const Rig& rig, std::span<const Body> bodies, std::span<const cv::Mat> panels,
                 const VirtualSensor& sensor) {
  check_rig(rig, "simulate: rig");
  check_virtual_sensor(sensor);
  if (bodies.empty()) throw InvalidInput("simulate: there is no body to look at; pass one or more");
  if (panels.empty())
    throw InvalidInput("simulate: there is no panel to project; pass one or more");
  for (std::size_t i = 0; i < bodies.size(); ++i) check_body(bodies[i], i);
  if (sensor.readout == Readout::demosaiced &&
      std::min(rig.camera.width, rig.camera.height) < kSmallestMosaic) {
    throw InvalidInput("simulate: rig: camera: a mosaic to interpolate in needs 3 x 3 px or more");
  }
}

}  // namespace

Simulation simulate(const Rig& rig, std::span<const Body> bodies, std::span<const cv::Mat> panels,
                    const VirtualSensor& sensor, Axis axis, std::uint64_t first_frame) {
  check_input(rig, bodies, panels, sensor);
  const LightPath path(rig, axis, sensor.projector_falloff);
  Renderer renderer{.camera = rig.camera,
                    .sensor = sensor,
                    .path = path,
                    .shifts = {rig.blue, ChromaticShift{}, rig.red},
                    .lights = {}};
  for (std::size_t i = 0; i < panels.size(); ++i) {
    renderer.lights.push_back(panel_light(panels[i], rig.projector, sensor,
                                          "simulate: panels[" + std::to_string(i) + "]"));
  }
  VirtualScene scene(bodies);
  std::vector<cv::Mat> images = expose(renderer, scene, panels.size());
  if (scene.moves()) scene.move_to(0.5);
  Simulation simulation{.frames = {}, .truth = scene_truth(scene, rig.camera, path), .exposure = 1};
  for (std::size_t i = 0; i < images.size(); ++i) {
    const cv::Mat light = gaussian_blur(images[i], sensor.camera_blur_px, Border::replicated);
    if (i == 0) simulation.exposure = choose_exposure(light, simulation.truth.lit, sensor);
    simulation.frames.push_back(read_out(light, simulation.exposure, sensor, first_frame + i));
  }
  return simulation;
}

}  // namespace palpate::sensing
