// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/virtual_sensor.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// Half a step of 16 bits, and the rounding of float light.
constexpr double kStep = 0.6 / 65535;

/// A quad of two triangles; the corners go round.
geometry::TriangleMesh quad(const Eigen::Matrix<double, 3, 4>& corners) {
  geometry::TriangleMesh mesh;
  mesh.vertices = corners;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 2, 3;
  return mesh;
}

/// The part of the plane normal . X = distance between four rays.
Body plane_body(const Eigen::Vector3d& normal, double distance, double reach = 0.5) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << -reach, reach, reach, -reach,  //
      -reach, -reach, reach, reach,         //
      1, 1, 1, 1;
  for (int k = 0; k < 4; ++k) corners.col(k) *= distance / normal.dot(corners.col(k));
  return {.mesh = quad(corners)};
}

/// The upright rectangle at depth z.
Body plate_body(double left, double right, double top, double bottom, double z) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << left, right, right, left, top, top, bottom, bottom, z, z, z, z;
  return {.mesh = quad(corners)};
}

cv::Mat white(const Rig& rig) {
  return {rig.projector.height, rig.projector.width, CV_32FC3, cv::Scalar::all(1)};
}

/// Without faults, and with an exposure that leaves room.
VirtualSensor plain() {
  VirtualSensor sensor = ideal({});
  sensor.exposure_distance = 800;
  sensor.exposure_level = 0.7;
  return sensor;
}

Simulation simulate_one(const Rig& rig, const std::vector<Body>& bodies, const cv::Mat& panel,
                        const VirtualSensor& sensor) {
  return simulate(rig, bodies, std::vector<cv::Mat>{panel}, sensor);
}

double bgr_value(const cv::Mat& frame, long row, long column, int channel = 1) {
  return frame.at<cv::Vec<ushort, 3>>(static_cast<int>(row), static_cast<int>(column))[channel] /
         65535.0;
}

Eigen::Vector3d projector_of(const Rig& rig) {
  return rig.T_projector_camera.inverse() * Eigen::Vector3d::Zero();
}

TEST(VirtualSensor, ShadesAPlaneByCosineAndInverseSquare) {
  const Rig rig = make_rig(true);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, 1).normalized();
  std::vector<Body> bodies = {plane_body(normal, 700)};
  bodies[0].reflectance = {0.5, 0.6, 0.9};
  bodies[0].specular = 0.3;
  bodies[0].shininess = 20;
  VirtualSensor sensor = plain();
  sensor.projector_falloff = 1.5;
  sensor.ambient = 0.05;
  const Simulation simulation = simulate_one(rig, bodies, white(rig), sensor);
  // A white surface that faces the light 800 mm away gets 1 / 0.8^2 and reads 0.7.
  const double exposure = 0.7 * 0.8 * 0.8;
  EXPECT_NEAR(simulation.exposure, exposure, 1e-12);
  const Eigen::Vector3d axis = rig.T_projector_camera.linear().row(2);
  int lit = 0;
  for (int v = 0; v < rig.camera.height; v += 7) {
    for (int u = 0; u < rig.camera.width; u += 7) {
      const Eigen::Vector3d ray = geometry::undistort(rig.camera, {u, v}).homogeneous();
      const Eigen::Vector3d place = ray * (700 / normal.dot(ray));
      EXPECT_NEAR(simulation.truth.range.z(v, u), place.z(), 1e-4);
      const Eigen::Vector3d to_light = projector_of(rig) - place;
      const Eigen::Vector3d half = (to_light.normalized() - place.normalized()).normalized();
      const double metres = to_light.norm() / 1000;
      const double light = simulation.truth.lit(v, u)
                               ? std::pow(-axis.dot(to_light.normalized()), 1.5) *
                                     -normal.dot(to_light.normalized()) / (metres * metres)
                               : 0;
      lit += light > 0;
      const double gloss = 0.3 * 28 / 8 * std::pow(-normal.dot(half), 20);
      for (int c = 0; c < 3; ++c) {
        const double reflectance = bodies[0].reflectance[2 - c];
        ASSERT_NEAR(bgr_value(simulation.frames[0], v, u, c),
                    std::min(1.0, exposure * ((reflectance + gloss) * light + 0.05 * reflectance)),
                    kStep)
            << v << ' ' << u;
      }
    }
  }
  EXPECT_GT(lit, 1000);
}

/// The scene of the tests of the decoder draws the pattern by its formula, ray by ray.
TEST(VirtualSensor, ShowsEachColourWhereTheOpticsOfTheRigSendIt) {
  for (const bool verging : {false, true}) {
    Rig rig = make_rig(verging);
    rig.camera.distortion = {-0.12, 0.07, 0.001, -0.0015};
    rig.projector.distortion = {-0.08, 0.03, -0.001, 0.002};
    rig.red = {.alpha = 0.999, .beta = 1.0006, .gamma = 0.002};
    rig.blue = {.alpha = 1.0014, .beta = 0.999, .gamma = -0.0015};
    for (const Axis axis : {Axis::x, Axis::y}) {
      const Pattern pattern{
          .axis = axis, .period = 40.3, .phase = 0.7, .mean = 0.5, .amplitude = 0.4};
      cv::Mat panel(rig.projector.height, rig.projector.width, CV_32FC1);
      panel.forEach<float>([&](float& light, const int* at) {
        const int p = axis == Axis::x ? at[1] : at[0];
        light = static_cast<float>(
            0.5 + 0.4 * std::cos(2 * std::numbers::pi * p / pattern.period + pattern.phase));
      });
      const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, 1).normalized();
      const std::vector<Body> bodies = {plane_body(normal, 700)};
      const std::vector<cv::Mat> panels = {panel, white(rig)};
      const Simulation simulation = simulate(rig, bodies, panels, plain(), axis);
      const Scene expected = render(rig, pattern, plane(normal, 700), 0, 1);
      // A chord of the cosine misses it by at most A (2 pi / period)^2 / 8 = 0.0013; quotients of
      // 16 bits are off by less than 0.0002.
      constexpr double kChord = 0.0015;
      int compared = 0;
      for (int v = 3; v < rig.camera.height; v += 5) {
        for (int u = 3; u < rig.camera.width; u += 5) {
          for (int c = 0; c < 3; ++c) {
            const double light = bgr_value(simulation.frames[1], v, u, c);
            const double wanted = bgr_value(expected.frame, v, u, c);
            if (light == 0 || wanted == 0) continue;  // at the panel's border
            ASSERT_NEAR(bgr_value(simulation.frames[0], v, u, c) / light, wanted, kChord)
                << v << ' ' << u << ' ' << c;
            ++compared;
          }
        }
      }
      EXPECT_GT(compared, 3000);
    }
  }
}

TEST(VirtualSensor, CastsTheShadowOfAPlate) {
  const Rig rig = make_rig(false);
  const std::vector<Body> bodies = {plane_body({0, 0, 1}, 1000.3),
                                    plate_body(-50.1, 40.2, -30.3, 35.7, 800.7)};
  const SceneTruth truth = simulate_one(rig, bodies, white(rig), plain()).truth;
  const Eigen::Vector3d light = projector_of(rig);
  int shadow = 0, front = 0;
  for (int v = 0; v < rig.camera.height; ++v) {
    for (int u = 0; u < rig.camera.width; ++u) {
      const Eigen::Vector3d ray = geometry::undistort(rig.camera, {u, v}).homogeneous();
      const auto on_plate = [](const Eigen::Vector3d& p) {
        return p.x() > -50.1 && p.x() < 40.2 && p.y() > -30.3 && p.y() < 35.7;
      };
      const bool is_front = on_plate(800.7 * ray);
      ASSERT_EQ(truth.body(v, u), is_front ? 1 : 0) << v << ' ' << u;
      if (!truth.covered(v, u)) continue;
      const Eigen::Vector3d place = 1000.3 * ray;
      const Eigen::Vector3d crossing =
          place + (light - place) * ((1000.3 - 800.7) / (1000.3 - light.z()));
      const bool is_shadow = !is_front && on_plate(crossing);
      ASSERT_EQ(truth.lit(v, u), !is_shadow) << v << ' ' << u;
      shadow += is_shadow;
      front += is_front;
    }
  }
  EXPECT_GT(shadow, 500);
  EXPECT_GT(front, 500);
}

TEST(VirtualSensor, SeesColoursOfVerticesAndTextures) {
  const Rig rig = make_rig(false);
  Body body = plate_body(-100, 100, -80, 80, 800);
  body.reflectance = {1, 1, 1};
  body.vertex_colors = Eigen::Matrix3Xd::Constant(3, 4, 1);
  body.vertex_colors->row(0) << 0, 1, 1, 0;  // red grows to the right
  body.texture = cv::Mat((cv::Mat_<uchar>(2, 1) << 255, 51));
  body.texture_coordinates.resize(2, 4);
  body.texture_coordinates << 0, 1, 1, 0, 1, 1, 0, 0;  // its first row is at the top
  Body blank = plate_body(-100, 100, -80, 80, 800);
  blank.reflectance = {1, 1, 1};
  const cv::Mat colored = simulate_one(rig, {body}, white(rig), plain()).frames[0];
  const cv::Mat bare = simulate_one(rig, {blank}, white(rig), plain()).frames[0];
  for (const int u : {110, 159, 200}) {
    const double x = (u - rig.camera.cx) / rig.camera.fx * 800;
    for (const int v : {100, 135}) {  // between the centres of the texels
      const double y = (v - rig.camera.cy) / rig.camera.fy * 800;
      const double row = (y + 80) / 80 - 0.5;
      const double texel = 1 + row * (0.2 - 1);
      EXPECT_NEAR(bgr_value(colored, v, u, 1) / bgr_value(bare, v, u, 1), texel, 1e-4);
      EXPECT_NEAR(bgr_value(colored, v, u, 2) / bgr_value(bare, v, u, 2), texel * (x + 100) / 200,
                  1e-4);
    }
  }
}

TEST(VirtualSensor, BlursWhatMovesAndTakesTheTruthInTheMiddle) {
  const Rig rig = make_rig(false);
  std::vector<Body> bodies = {plate_body(-300, 0.1, -300, 300, 800)};
  VirtualSensor sensor = plain();
  const cv::Mat rest = simulate_one(rig, bodies, white(rig), sensor).frames[0];
  // Its right edge goes 20 px to the right, and it comes 40 mm nearer.
  constexpr double kPixel = 800 / 550.0;
  bodies[0].end_vertices = bodies[0].mesh.vertices.colwise() + Eigen::Vector3d(20 * kPixel, 0, -40);
  sensor.exposure_steps = 4;
  const Simulation moving = simulate_one(rig, bodies, white(rig), sensor);
  EXPECT_NEAR(moving.truth.range.z(120, 100), 780, 1e-4);
  EXPECT_FALSE(std::isfinite(moving.truth.range.z(120, 171)));
  // Light of the steps at which the edge was already there: three of four, two, one, none.
  const double full = bgr_value(moving.frames[0], 120, 155);
  EXPECT_NEAR(full, bgr_value(rest, 120, 155), 0.1 * full);
  const double quarters[] = {3, 2, 1, 0};
  const int columns[] = {164, 169, 174, 179};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(bgr_value(moving.frames[0], 120, columns[i]) / full, quarters[i] / 4, 0.04) << i;
  }
}

TEST(VirtualSensor, SamplesAPixelThatIsPartlyCovered) {
  const Rig rig = make_rig(false);
  VirtualSensor sensor = plain();
  sensor.samples_per_axis = 4;
  // The edge is at column 159.78: of the samples of column 160, which begins at 159.5, the first
  // is before it, the second, at 159.875, is not.
  const double edge = (159.78 - rig.camera.cx) / rig.camera.fx * 800;
  const cv::Mat frame =
      simulate_one(rig, {plate_body(-300, edge, -300, 300, 800)}, white(rig), sensor).frames[0];
  EXPECT_NEAR(bgr_value(frame, 120, 160) / bgr_value(frame, 120, 159), 0.25, 0.01);
  EXPECT_EQ(bgr_value(frame, 120, 161), 0);
}

TEST(VirtualSensor, GivesTheSameFrameOnAnyNumberOfThreads) {
  const Rig rig = make_rig(true);
  const std::vector<Body> bodies = {plane_body({0.1, 0, 1}, 700)};
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return simulate_one(rig, bodies, white(rig), {}).frames[0];
  };
  EXPECT_EQ(cv::norm(run(1), run(4), cv::NORM_INF), 0);
}

TEST(VirtualSensor, NumbersFramesSoThatTheirNoiseDiffers) {
  const Rig rig = make_rig(true);
  const std::vector<Body> bodies = {plane_body({0.1, 0, 1}, 700)};
  const std::vector<cv::Mat> panels = {white(rig), white(rig)};
  const Simulation both = simulate(rig, bodies, panels, {}, Axis::y, 7);
  const Simulation second = simulate(rig, bodies, std::span(panels).first(1), {}, Axis::y, 8);
  EXPECT_GT(cv::norm(both.frames[0], both.frames[1], cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(both.frames[1], second.frames[0], cv::NORM_INF), 0);
}

TEST(VirtualSensor, SeesNothingWhereNothingIs) {
  const Rig rig = make_rig(false);
  for (const double z : {-800.0, 0.0}) {
    const Simulation simulation =
        simulate_one(rig, {plate_body(-300, 300, -300, 300, z)}, white(rig), ideal({}));
    EXPECT_TRUE(simulation.truth.range.z.isNaN().all());
    EXPECT_FALSE(simulation.truth.lit.any());
    EXPECT_EQ(cv::norm(simulation.frames[0], cv::NORM_INF), 0);
  }
}

TEST(VirtualSensor, StandsTrianglesWithoutArea) {
  const Rig rig = make_rig(false);
  Body body = plate_body(-300, 300, -300, 300, 800);
  body.mesh.vertices.col(3) = body.mesh.vertices.col(2);
  const Simulation simulation = simulate_one(rig, {body}, white(rig), plain());
  const cv::Mat& frame = simulation.frames[0];
  EXPECT_GT(bgr_value(frame, 20, 300), 0.1);
  EXPECT_TRUE(simulation.truth.range.z.isNaN().any());
}

TEST(VirtualSensor, RefusesWhatItCannotSimulate) {
  const Rig rig = make_rig(false);
  const Body good = plate_body(-300, 300, -300, 300, 800);
  const auto refusal = [&](const std::vector<Body>& bodies, const cv::Mat& panel,
                           const VirtualSensor& sensor) {
    return message_of<InvalidInput>([&] { (void)simulate_one(rig, bodies, panel, sensor); });
  };
  EXPECT_NE(refusal({}, white(rig), {}).find("no body"), std::string::npos);
  EXPECT_NE(refusal({good}, cv::Mat(3, 4, CV_8UC3), {}).find("the projector has 1024 x 768"),
            std::string::npos);
  Body bad = good;
  bad.mesh.vertices(1, 2) = std::nan("");
  EXPECT_NE(refusal({good, bad}, white(rig), {}).find("bodies[1]"), std::string::npos);
  bad = good;
  bad.end_vertices = Eigen::Matrix3Xd::Zero(3, 3);
  EXPECT_NE(refusal({bad}, white(rig), {}).find("end_vertices: has 3 columns"), std::string::npos);
  bad = good;
  bad.texture = cv::Mat(2, 2, CV_8UC1, cv::Scalar(1));
  EXPECT_NE(refusal({bad}, white(rig), {}).find("texture_coordinates"), std::string::npos);
  bad = good;
  bad.reflectance = {0.5, std::nan(""), 0.5};
  EXPECT_NE(refusal({bad}, white(rig), {}).find("reflectance"), std::string::npos);
  cv::Mat panel = white(rig);
  panel.at<cv::Vec3f>(5, 6)[1] = 1.5F;
  EXPECT_NE(refusal({good}, panel, {}).find("row 5, column 6"), std::string::npos);
  VirtualSensor sensor;
  sensor.bits = 12;
  EXPECT_NE(refusal({good}, white(rig), sensor).find("; it must be 8 or 16"), std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
