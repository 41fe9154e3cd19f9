// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "more_scenes.h"

#include <Eigen/Geometry>
#include <cmath>

#include "palpate/sensing/pattern_design.h"
#include "palpate/sensing/pattern_image.h"
#include "palpate/sensing/rig_assessment.h"
#include "palpate/sensing/virtual_sensor.h"
#include "test_surfaces.h"

namespace palpate::bench {
namespace {

using geometry::test::height_field;
using geometry::test::icosphere;
using geometry::test::moved;
using sensing::Body;
using sensing::VirtualSensor;

/// A rig, the pattern for it, and colours that were trained on a white wall.
struct Setup {
  std::string name;
  sensing::Rig rig = {};
  sensing::Pattern pattern = {};
  VirtualSensor sensor = {};
  sensing::TrainedColors colors = {};
};

Body sheet_at(const std::function<double(double, double)>& depth) {
  constexpr double kWidth = 1400, kHeight = 1100, kSpacing = 4;  // mm
  Body body;
  body.mesh = height_field(
      static_cast<int>(kWidth / kSpacing), static_cast<int>(kHeight / kSpacing), kSpacing,
      [&](double x, double y) { return depth(x - kWidth / 2, y - kHeight / 2); });
  body.mesh.vertices.row(0).array() -= kWidth / 2;
  body.mesh.vertices.row(1).array() -= kHeight / 2;
  return body;
}

Body flat(double z, double across = 0, double down = 0) {
  return sheet_at([=](double x, double y) { return z + across * x + down * y; });
}

Body sphere(const Eigen::Vector3d& center, double radius) {
  Body body;
  body.mesh = moved(icosphere(5, radius), Eigen::Isometry3d(Eigen::Translation3d(center)));
  return body;
}

Body painted(Body body, const Eigen::Vector3d& reflectance) {
  body.reflectance = reflectance;
  return body;
}

/// The projector is to the right of and above the camera, turned towards the object and rolled.
Setup turned_rig() {
  Setup setup{.name = "turned"};
  setup.rig.camera = {.width = 640, .height = 480, .fx = 860, .fy = 862, .cx = 325, .cy = 236};
  setup.rig.camera.distortion[0] = -0.08;
  setup.rig.projector = {
      .width = 1280, .height = 800, .fx = 1750, .fy = 1748, .cx = 640, .cy = 400};
  setup.rig.T_projector_camera.linear() = (Eigen::AngleAxisd(0.21, Eigen::Vector3d::UnitX()) *
                                           Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
                                           Eigen::AngleAxisd(0.035, Eigen::Vector3d::UnitZ()))
                                              .toRotationMatrix();
  setup.rig.T_projector_camera.translation() =
      setup.rig.T_projector_camera.linear() * Eigen::Vector3d(-170, 180, -10);
  setup.sensor.camera_blur_px = 0.8;
  return setup;
}

/// The sinusoid runs along the columns; a camera without a mosaic.
Setup sideways_rig() {
  Setup setup{.name = "sideways"};
  setup.rig.camera = {
      .width = 640, .height = 480, .fx = 1000, .fy = 1000, .cx = 319.5, .cy = 239.5};
  setup.rig.projector = {.width = 1024, .height = 768, .fx = 1400, .fy = 1400, .cx = 60, .cy = 160};
  setup.rig.T_projector_camera.translation() = Eigen::Vector3d(190, 120, 10);
  setup.rig.red.alpha = 1.0008;
  setup.rig.blue.alpha = 0.9993;
  setup.sensor.readout = sensing::Readout::color;
  setup.sensor.full_well = 6000;
  return setup;
}

void prepare(Setup& setup) {
  setup.pattern = sensing::design_pattern(setup.rig).pattern;
  const std::vector<Body> white = {flat(750)};
  const auto seen =
      simulate(setup.rig, white, sensing::color_panels(setup.pattern, setup.rig.projector),
               setup.sensor, setup.pattern.axis, 1000);
  std::vector<sensing::NamedImages> images;
  for (std::size_t i = 0; i < setup.pattern.colors.size(); ++i) {
    images.push_back({setup.pattern.colors[i].name, {seen.frames[i]}});
  }
  setup.colors = sensing::train_colors(images);
}

Scene scene_of(const Setup& setup, const char* name, const std::vector<std::vector<Body>>& groups,
               const VirtualSensor& sensor) {
  Scene scene{setup.name + " " + name, setup.rig, setup.pattern, setup.colors, {}};
  const std::vector<cv::Mat> panels = {sensing::draw_pattern(setup.pattern, setup.rig)};
  for (const std::vector<Body>& bodies : groups) {
    sensing::Simulation seen =
        simulate(setup.rig, bodies, panels, sensor, setup.pattern.axis, scene.views.size());
    View view;
    view.frame = seen.frames[0];
    view.counted = seen.truth.lit && seen.truth.incidence <= static_cast<float>(kMaxIncidence);
    view.z = std::move(seen.truth.range.z);
    scene.views.push_back(std::move(view));
  }
  return scene;
}

void add_scenes(Setup setup, std::vector<Scene>& scenes) {
  prepare(setup);
  const auto add = [&](const char* name, const std::vector<std::vector<Body>>& groups,
                       const VirtualSensor& sensor) {
    scenes.push_back(scene_of(setup, name, groups, sensor));
  };
  const auto usual = [&](const char* name, const std::vector<std::vector<Body>>& groups) {
    add(name, groups, setup.sensor);
  };
  const Body wave = sheet_at(
      [](double x, double y) { return 780 + 25 * std::sin(x / 60) * std::cos(y / 45) + 0.1 * x; });
  usual("wall", {{flat(650)}, {flat(1000)}});
  usual("slopes", {{flat(800, 0.25, 0.1)}, {flat(700, -0.1, -0.2)}});
  usual("waves", {{wave}});
  usual("balls", {{sphere({-40, 10, 690}, 60), sphere({70, -30, 760}, 50), flat(880)}});
  usual("orange wall", {{painted(flat(800, 0.1, 0), {0.8, 0.4, 0.1})}});
  usual("pink wall", {{painted(flat(800, 0, 0.1), {0.8, 0.3, 0.4})}});
  usual("dark red wall", {{painted(flat(800, 0, 0.1), {0.8, 0.15, 0.15})}});
  usual("green waves", {{painted(wave, {0.1, 0.8, 0.2})}});
  usual("blue ball alone", {{painted(sphere({0, 0, 700}, 90), {0.05, 0.05, 0.8})}});
  usual("red ball alone", {{painted(sphere({0, 0, 700}, 90), {0.8, 0.03, 0.03})}});
  usual("white ball alone", {{sphere({10, -20, 720}, 55)}});
  usual("marbles", {{sphere({10, -20, 720}, 9), sphere({-50, 30, 700}, 7)}});
  usual("nothing", {{sphere({0, 0, 720}, 1)}});
  VirtualSensor sensor = setup.sensor;
  sensor.exposure_level = 0.05;
  add("dim waves", {{wave}}, sensor);
  sensor = setup.sensor;
  sensor.ambient = 0.8;
  sensor.camera_blur_px = 1.6;
  add("blurred waves", {{wave}}, sensor);
}

}  // namespace

std::vector<Scene> scenes_of_other_rigs() {
  std::vector<Scene> scenes;
  add_scenes(turned_rig(), scenes);
  add_scenes(sideways_rig(), scenes);
  return scenes;
}

}  // namespace palpate::bench
