// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "simulated_scenes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "palpate/geometry/mesh_io.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/rig_assessment.h"
#include "repository.h"
#include "test_surfaces.h"
#include "textures.h"

namespace palpate::bench {
namespace {

namespace fs = std::filesystem;
using geometry::test::height_field;
using geometry::test::moved;
using sensing::Body;
using sensing::VirtualSensor;

/// The bundled rig and pattern.
struct Bench {
  sensing::Rig rig;
  sensing::Pattern pattern;
  cv::Mat panel;
};

const Bench& bench() {
  static const Bench loaded = [] {
    const fs::path demo = repository("demo");
    return Bench{sensing::read_rig(demo / "rig.yaml"), sensing::read_pattern(demo / "pattern.yaml"),
                 sensing::read_frame(demo / "pattern.png")};
  }();
  return loaded;
}

VirtualSensor camera_with(const CameraNoise& noise) { return {.full_well = noise.full_well}; }

// ---- bodies ------------------------------------------------------------------------------------

/// [mm] Sheets are so wide, enough to fill the view at any distance that is used.
constexpr double kSheetWidth = 1000;
constexpr double kSheetHeight = 760;

/// [mm] Spacing of flat sheets: a divisor of both.
constexpr double kFlatSpacing = 20;

/// z(x, y) about the camera's axis, with a print whose picture spans the whole sheet.
/// \param spacing [mm] of the vertices; what is left of the width and height is missing.
Body sheet(double spacing, const std::function<double(double, double)>& depth) {
  Body body;
  body.mesh = height_field(
      static_cast<int>(kSheetWidth / spacing), static_cast<int>(kSheetHeight / spacing), spacing,
      [&](double x, double y) { return depth(x - kSheetWidth / 2, y - kSheetHeight / 2); });
  body.mesh.vertices.row(0).array() -= kSheetWidth / 2;
  body.mesh.vertices.row(1).array() -= kSheetHeight / 2;
  body.texture_coordinates.resize(2, body.mesh.vertices.cols());
  body.texture_coordinates.row(0) = body.mesh.vertices.row(0).array() / kSheetWidth + 0.5;
  body.texture_coordinates.row(1) = 0.5 - body.mesh.vertices.row(1).array() / kSheetHeight;
  return body;
}

Body wall(double z) {
  return sheet(kFlatSpacing, [z](double, double) { return z; });
}

Body ball(const Eigen::Vector3d& center, double radius, const Eigen::Vector3d& reflectance) {
  Body body;
  body.mesh =
      moved(geometry::test::icosphere(5, radius), Eigen::Isometry3d(Eigen::Translation3d(center)));
  body.reflectance = reflectance;
  return body;
}

Body hand() {
  Body body;
  body.mesh = geometry::read_mesh(repository("meshes/hand.ply"));
  const Eigen::Vector3d low = body.mesh.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = body.mesh.vertices.rowwise().maxCoeff();
  body.mesh.vertices.colwise() += Eigen::Vector3d(0, 0, 700) - (low + high) / 2;
  return body;
}

/// [mm] Length of a period of the sinusoid on a wall at this distance that faces the rig.
double period_at(double z) { return bench().pattern.period * z / bench().rig.projector.fy; }

Body printed(Body body, const cv::Mat& texture) {
  body.texture = texture;
  return body;
}

/// Its axis points down.
Body cylinder(double z, double radius, double height) {
  constexpr int kSides = 96;
  Body body;
  body.mesh.vertices.resize(3, 2 * kSides);
  body.mesh.triangles.resize(3, 2 * kSides);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    for (const int end : {0, 1}) {
      body.mesh.vertices.col(2 * i + end) = Eigen::Vector3d(
          radius * std::cos(angle), height * (end - 0.5), z + radius * std::sin(angle));
    }
    const int next = 2 * ((i + 1) % kSides);
    body.mesh.triangles.col(2 * i) << 2 * i, next, 2 * i + 1;
    body.mesh.triangles.col(2 * i + 1) << 2 * i + 1, next, next + 1;
  }
  return body;
}

double folds(double x, double y) {
  constexpr double kFold = 95, kDepth = 18;  // mm: slopes of up to 50 degrees
  return 760 + kDepth * std::sin(2 * std::numbers::pi * (y + 0.35 * x) / kFold);
}

double bulge(double x, double y) { return 780 - 60 * std::cos(x / 160) * std::cos(y / 130); }

/// Depth at which the axis' neighbour (x, y) is lit `periods` periods from where it is at `z`.
double periods_further(double z, const Eigen::Vector3d& ray, int periods) {
  const Bench& b = bench();
  const auto pixel = [&](double depth) {
    const Eigen::Vector3d place = b.rig.T_projector_camera * (ray * depth);
    return geometry::distort(b.rig.projector, place.hnormalized()).y();
  };
  const double wanted = pixel(z) - periods * b.pattern.period;
  double near = z / 2, far = 2 * z;
  for (int i = 0; i < 60; ++i) {
    const double middle = (near + far) / 2;
    (pixel(middle) > wanted ? near : far) = middle;
  }
  return near;
}

/// Upright tiles, each a whole number of periods further than 700 mm: the phase goes on across
/// their borders as if there were none.
std::vector<Body> period_steps() {
  constexpr int kColumns = 5, kRows = 4;
  constexpr double kTile = 0.12;  // tangent of the angle it spans
  constexpr int kPeriods[kRows][kColumns] = {
      {0, 1, 0, 2, 0}, {1, 0, 3, 0, 1}, {0, 2, 0, 1, 0}, {1, 0, 1, 0, 2}};
  std::vector<Body> tiles;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const Eigen::Vector2d middle(kTile * (c - (kColumns - 1) / 2.0),
                                   kTile * (r - (kRows - 1) / 2.0));
      const double z = periods_further(700, middle.homogeneous(), kPeriods[r][c]);
      Body tile;
      tile.mesh = geometry::test::flat_sheet(1, 1, kTile * z);
      const Eigen::Vector2d corner = z * (middle.array() - kTile / 2);
      tile.mesh.vertices.colwise() += corner.homogeneous().eval();
      tile.mesh.vertices.row(2).setConstant(z);
      tiles.push_back(std::move(tile));
    }
  }
  tiles.push_back(wall(periods_further(700, {0, 0, 1}, 6)));
  return tiles;
}

/// [mm] A move along the camera's axis that shifts the sinusoid by some 5 px on the wall.
constexpr double kApproach = 20;

/// The bodies on their way towards the camera, at their places in the middle of the exposure.
std::vector<Body> approaching(std::vector<Body> bodies, double way) {
  for (Body& body : bodies) {
    body.mesh.vertices.row(2).array() += way / 2;
    body.end_vertices = body.mesh.vertices;
    body.end_vertices->row(2).array() -= way;
  }
  return bodies;
}

/// Bars of 2 to 8 px before a wall.
std::vector<Body> wires() {
  std::vector<Body> bodies = {wall(800)};
  for (int i = 0; i < 14; ++i) {
    const bool upright = i % 2 == 0;
    const double width = 1.3 + 0.3 * i, at = -170 + 26.0 * i;  // mm
    Body bar;
    bar.mesh = geometry::test::flat_sheet(1, 1, 1);
    bar.mesh.vertices.row(0).array() = upright ? at + width * bar.mesh.vertices.row(0).array()
                                               : -150 + 300 * bar.mesh.vertices.row(0).array();
    bar.mesh.vertices.row(1).array() = upright
                                           ? -110 + 220 * bar.mesh.vertices.row(1).array()
                                           : 0.7 * at + width * bar.mesh.vertices.row(1).array();
    bar.mesh.vertices.row(2).setConstant(upright ? 690 : 650);
    bodies.push_back(std::move(bar));
  }
  return bodies;
}

// ---- scenes ------------------------------------------------------------------------------------

/// Trains the colours as a user would: on a white wall, with the camera that is used.
sensing::TrainedColors trained(const VirtualSensor& sensor) {
  const Bench& b = bench();
  const std::vector<Body> white = {wall(750)};
  const auto seen = simulate(b.rig, white, sensing::color_panels(b.pattern, b.rig.projector),
                             sensor, b.pattern.axis, 1000);
  std::vector<sensing::NamedImages> images;
  for (std::size_t i = 0; i < b.pattern.colors.size(); ++i) {
    images.push_back({b.pattern.colors[i].name, {seen.frames[i]}});
  }
  return sensing::train_colors(images);
}

View simulated_view(const std::vector<Body>& bodies, const VirtualSensor& sensor,
                    std::uint64_t number, sensing::PixelLabels* labels = nullptr) {
  const Bench& b = bench();
  const std::vector<cv::Mat> panels = {b.panel};
  sensing::Simulation seen = simulate(b.rig, bodies, panels, sensor, b.pattern.axis, number);
  View view;
  view.frame = seen.frames[0];
  view.counted = seen.truth.lit && seen.truth.incidence <= static_cast<float>(kMaxIncidence);
  view.z = std::move(seen.truth.range.z);
  if (labels != nullptr) *labels = std::move(seen.truth.body);
  return view;
}

/// Counts only pixels of the first body, and only where it reflects the stripe that its depth
/// implies.
void count_reflected(const Eigen::Vector3d& reflectance, const sensing::PixelLabels& body,
                     View& view) {
  constexpr double kLeastReflected = 0.1;
  const Bench& b = bench();
  const auto& edges = b.pattern.stripe_edges;
  for (int v = 0; v < view.frame.rows; ++v) {
    for (int u = 0; u < view.frame.cols; ++u) {
      if (!view.counted(v, u)) continue;
      const Eigen::Vector3d ray = geometry::undistort(b.rig.camera, {u, v}).homogeneous();
      const Eigen::Vector3d point =
          b.rig.T_projector_camera * (ray * static_cast<double>(view.z(v, u)));
      const double across = geometry::distort(b.rig.projector, point.hnormalized()).x();
      const auto stripe = static_cast<std::size_t>(
          std::upper_bound(edges.begin(), edges.end(), across) - edges.begin());
      const Eigen::Vector3d& light =
          b.pattern.colors[static_cast<std::size_t>(b.pattern.stripes[stripe])].rgb;
      const bool reflected =
          light.cwiseProduct(reflectance).maxCoeff() >= kLeastReflected * reflectance.maxCoeff();
      view.counted(v, u) = reflected && body(v, u) == 0;
    }
  }
}

Scene scene_of(const std::string& name, const std::vector<std::vector<Body>>& groups,
               const VirtualSensor& sensor, const sensing::TrainedColors& colors) {
  Scene scene{name, bench().rig, bench().pattern, colors, {}};
  for (std::size_t i = 0; i < groups.size(); ++i) {
    scene.views.push_back(simulated_view(groups[i], sensor, i));
  }
  return scene;
}

}  // namespace

std::vector<Scene> smooth_scenes(const CameraNoise& noise) {
  const VirtualSensor sensor = camera_with(noise);
  const sensing::TrainedColors colors = trained(sensor);
  const auto plane = [](double z, double across, double down) {
    return sheet(kFlatSpacing, [=](double x, double y) { return z + across * x + down * y; });
  };
  return {scene_of("planes", {{plane(560, 0.2, 0)}, {plane(700, 0, -0.35)}, {plane(900, 0.1, 0.2)}},
                   sensor, colors),
          scene_of("folds", {{sheet(2.5, folds)}}, sensor, colors),
          scene_of("hand", {{hand(), wall(900)}}, sensor, colors),
          scene_of("print", {{printed(sheet(10, bulge), print({0.25, 0.3}))}}, sensor, colors)};
}

std::vector<Scene> hard_scenes() {
  const VirtualSensor usual = camera_with(kUsualNoise);
  const sensing::TrainedColors colors = trained(usual);
  const Eigen::Vector3d before_wall(0, 10, 720), white(0.8, 0.8, 0.8);
  const auto before = [&](const Body& body) { return std::vector<Body>{body, wall(850)}; };
  std::vector<Scene> scenes;
  const auto add = [&](const std::string& name, const std::vector<Body>& bodies,
                       const VirtualSensor& sensor) {
    scenes.push_back(scene_of(name, {bodies}, sensor, colors));
  };
  add("red ball", before(ball(before_wall, 80, {0.8, 0.04, 0.04})), usual);
  add("purely red ball", before(ball(before_wall, 80, {0.8, 0, 0})), usual);
  add("blue ball", before(ball(before_wall, 80, {0.04, 0.04, 0.8})), usual);
  add(
      "green hand",
      [&] {
        Body green = hand();
        green.reflectance = {0.04, 0.8, 0.04};
        return before(green);
      }(),
      usual);
  add(
      "red wall",
      [] {
        Body red = sheet(10, bulge);
        red.reflectance = {0.8, 0.03, 0.03};
        return std::vector<Body>{red};
      }(),
      usual);
  add("strong print", {printed(sheet(10, bulge), print({0.03, 1}))}, usual);
  constexpr double kTiled = 750;
  const Body tiled = sheet(10, [](double x, double y) { return kTiled + 0.15 * x - 0.1 * y; });
  add("grey tiles",
      {printed(tiled, tiles({kSheetWidth, kSheetHeight}, period_at(kTiled), {0.25, 0}))}, usual);
  add("coloured tiles",
      {printed(tiled, tiles({kSheetWidth, kSheetHeight}, period_at(kTiled), {0.25, 0.5}))}, usual);
  add("steps of whole periods", period_steps(), usual);
  add("wires", wires(), usual);
  add(
      "glossy ball",
      [&] {
        Body glossy = ball(before_wall, 80, white);
        glossy.specular = 0.6;
        return before(glossy);
      }(),
      usual);
  const std::vector<Body> usual_bodies = {ball(before_wall, 80, white), wall(850)};
  VirtualSensor sensor = usual;
  sensor.ambient = 1;
  add("bright room", usual_bodies, sensor);
  sensor = usual;
  sensor.exposure_level = 0.06;
  add("little light", usual_bodies, sensor);
  sensor = usual;
  sensor.exposure_percentile = 0.6;
  sensor.exposure_level = 1;
  add("overexposed", usual_bodies, sensor);
  for (const double defocus : {1.5, 2.5}) {
    sensor = usual;
    sensor.camera_blur_px = std::hypot(usual.camera_blur_px, defocus);
    add(fmt::format("defocus of {} px", defocus), usual_bodies, sensor);
  }
  add("motion", approaching(usual_bodies, kApproach), usual);
  return scenes;
}

std::vector<Scene> painted_scenes() {
  const VirtualSensor usual = camera_with(kUsualNoise);
  const sensing::TrainedColors colors = trained(usual);
  const struct {
    const char* name;
    Eigen::Vector3d reflectance;
  } paints[] = {{"red", {0.8, 0.04, 0.04}},      {"purely red", {0.8, 0, 0}},
                {"green", {0.04, 0.8, 0.04}},    {"purely green", {0, 0.8, 0}},
                {"blue", {0.04, 0.04, 0.8}},     {"purely blue", {0, 0, 0.8}},
                {"dark red", {0.3, 0.01, 0.01}}, {"dark blue", {0.02, 0.01, 0.25}},
                {"orange", {0.8, 0.25, 0.03}},   {"skin", {0.8, 0.5, 0.4}}};
  const auto tilted = [](double x, double y) { return 750 + 0.25 * x - 0.2 * y; };
  std::vector<Scene> scenes;
  for (const auto& paint : paints) {
    Scene scene{paint.name, bench().rig, bench().pattern, colors, {}};
    const std::vector<std::vector<Body>> groups = {{cylinder(760, 70, 260), wall(900)},
                                                   {ball({0, 10, 720}, 80, {1, 1, 1}), wall(900)},
                                                   {sheet(10, bulge)},
                                                   {sheet(kSheetHeight / 4, tilted)}};
    for (std::vector<Body> bodies : groups) {
      bodies[0].reflectance = paint.reflectance;
      sensing::PixelLabels body;
      View view = simulated_view(bodies, usual, scene.views.size(), &body);
      count_reflected(paint.reflectance, body, view);
      scene.views.push_back(std::move(view));
    }
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

}  // namespace palpate::bench
