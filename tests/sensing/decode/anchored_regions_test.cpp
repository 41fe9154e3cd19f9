// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/anchored_regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/pattern_image.h"
#include "palpate/sensing/virtual_sensor.h"
#include "synthetic_scene.h"
#include "test_files.h"
#include "test_surfaces.h"

namespace palpate::sensing {
namespace {

Pattern sinusoid(Axis axis) {
  return {.axis = axis, .period = 20, .phase = 0.3, .mean = 0.5, .amplitude = 0.4};
}

Anchor anchor_at(const Scene& scene, int u, int v, double factor = 1) {
  return {.u_px = static_cast<double>(u),
          .v_px = static_cast<double>(v),
          .z = factor * static_cast<double>(scene.z(v, u))};
}

std::string text_of(const Anchor& anchor) {
  std::ostringstream text;
  text << anchor.u_px << ',' << anchor.v_px << ',' << anchor.z;
  return text.str();
}

TEST(AnchoredRegions, NameTwoAnchorsThatContradictEachOther) {
  const Rig rig = make_rig(false);
  for (const Axis axis : {Axis::x, Axis::y}) {
    const Scene scene = render(rig, sinusoid(axis), plane({0.1, -0.2, 1}, 650));
    const Anchor right = anchor_at(scene, 80, 60), wrong = anchor_at(scene, 200, 150, 1.08);
    for (const Segmentation segmentation : {Segmentation::flood, Segmentation::snakes}) {
      const auto decode = [&](const std::vector<Anchor>& anchors) {
        return Decoder(rig, sinusoid(axis), {}, {.segmentation = segmentation, .anchors = anchors})
            .decode(scene.frame);
      };
      EXPECT_NO_THROW(decode({right, anchor_at(scene, 200, 150)}));
      const std::string message = message_of<InvalidInput>([&] { decode({right, wrong}); });
      EXPECT_NE(message.find(text_of(right)), std::string::npos) << message;
      EXPECT_NE(message.find(text_of(wrong)), std::string::npos) << message;
      // Its true depth, to a tenth of a millimetre.
      const auto at = message.find("pixel 200,150 is at ");
      ASSERT_NE(at, std::string::npos) << message;
      EXPECT_NEAR(std::stod(message.substr(at + 20)), static_cast<double>(scene.z(150, 200)), 0.2);
    }
  }
}

// Both are right, on two surfaces that the phase alone connects.
TEST(AnchoredRegions, TakeAnchorsOnBothSidesOfAStep) {
  const Rig rig = make_rig(false);
  for (const double distance : {500.0, 545.0, 590.0, 620.0}) {
    const Scene scene =
        render(rig, sinusoid(Axis::y), nearer(sphere({0, 0, distance}, 50), plane({0, 0, 1}, 720)));
    const Decoder decoder(rig, sinusoid(Axis::y), {},
                          {.anchors = {anchor_at(scene, 20, 120), anchor_at(scene, 160, 120)}});
    EXPECT_NO_THROW((void)decoder.decode(scene.frame)) << distance;
  }
}

/// A tilted card of another material in front of a wall.
Scene card_before_wall(const Rig& rig, const Pattern& pattern, double distance) {
  Scene scene = render(rig, pattern, plane({0, 0, 1}, 720));
  const Scene card = render(rig, pattern, plane({0.1, 0.4, 1}, distance), 0.1, 0.2);
  const cv::Rect place(60, 70, 160, 110);
  card.frame(place).copyTo(scene.frame(place));
  scene.z.block(place.y, place.x, place.height, place.width) =
      card.z.block(place.y, place.x, place.height, place.width);
  return scene;
}

// With one anchor on the wall, and with one on the card at this distance [mm].
void expect_few_wrong_depths(const Rig& rig, const Scene& scene, double distance) {
  for (const Anchor& anchor : {anchor_at(scene, 20, 40), anchor_at(scene, 140, 125)}) {
    const DecodeResult result =
        Decoder(rig, sinusoid(Axis::y), {}, {.anchors = {anchor}}).decode(scene.frame);
    const auto known = result.range.z > 0;
    const auto wrong = known && (result.range.z - scene.z).abs() > 8;  // half a period, nearly
    EXPECT_GE(known.count(), 5000) << distance << ' ' << anchor.u_px;
    EXPECT_LE(static_cast<double>(wrong.count()), 0.01 * static_cast<double>(known.count()))
        << distance << ' ' << anchor.u_px;
  }
}

TEST(AnchoredRegions, EndAtStepsWhoseWholePeriodsThePhaseDoesNotShow) {
  const Rig rig = make_rig(false);
  for (const double distance : {640.0, 600.0, 565.0, 530.0}) {
    const Scene scene = card_before_wall(rig, sinusoid(Axis::y), distance);
    expect_few_wrong_depths(rig, scene, distance);
  }
}

// The light changes little from the card to the wall, and the phase by a fraction of a turn that is
// zero at places along each side.
TEST(AnchoredRegions, EndAtStepsBeforeAWallOfTheSameColour) {
  const Rig rig = make_rig(false);
  for (const double distance : {640.0, 600.0, 565.0}) {
    const Surface wall = plane({0, 0, 1}, 720), card = plane({0.1, 0.15, 1}, distance);
    const Surface both = [&](const Eigen::Vector2d& ray) {
      const bool beside = std::abs(ray.x() + 0.03) > 0.15 || std::abs(ray.y()) > 0.11;
      return beside ? wall(ray) : card(ray);
    };
    Scene scene = render(rig, sinusoid(Axis::y), both);
    add_noise(scene.frame, 0.002, 5);
    expect_few_wrong_depths(rig, scene, distance);
  }
}

TEST(AnchoredRegions, KeepASmoothReliefWhole) {
  const Rig rig = make_rig(false);
  const Surface relief = [](const Eigen::Vector2d& ray) {
    return 700 + 4 * std::sin(40 * ray.x()) * std::cos(30 * ray.y());
  };
  Scene scene = render(rig, sinusoid(Axis::y), relief);
  add_noise(scene.frame, 0.005, 3);
  const DecodeResult result =
      Decoder(rig, sinusoid(Axis::y), {}, {.anchors = {anchor_at(scene, 160, 120)}})
          .decode(scene.frame);
  const auto right = (result.range.z - scene.z).abs() < 2;
  EXPECT_GE(static_cast<double>(right.count()), 0.95 * static_cast<double>(scene.z.size()));
}

/// A rectangle that faces the camera [mm].
Body board(double z, double width, double height, const Eigen::Vector2d& center = {0, 0}) {
  Body body;
  body.mesh = geometry::test::height_field(1, 1, 1, [](double, double) { return 0.0; });
  body.mesh.vertices.row(0) = (body.mesh.vertices.row(0).array() - 0.5) * width + center.x();
  body.mesh.vertices.row(1) = (body.mesh.vertices.row(1).array() - 0.5) * height + center.y();
  body.mesh.vertices.row(2).setConstant(z);
  return body;
}

/// What a camera sees of bodies, the baseline of 223 mm at an angle to the sinusoid [degrees].
struct View {
  Rig rig = make_rig(false);
  Simulation simulation = {};

  View(double degrees, const std::vector<Body>& bodies) {
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d t(223 * std::sin(angle), 223 * std::cos(angle), -20);
    rig.camera = {.width = 640, .height = 480, .fx = 1100, .fy = 1100, .cx = 319.5, .cy = 239.5};
    rig.projector.width = 1400;
    rig.projector.height = 1100;
    rig.projector.cx = 699.5 - rig.projector.fx * t.x() / 680;
    rig.projector.cy = 549.5 - rig.projector.fy * t.y() / 680;
    rig.T_projector_camera.translation() = t;
    const std::vector<cv::Mat> panels(1, draw_pattern(sinusoid(Axis::y), 1400, 1100, 16));
    simulation = simulate(rig, bodies, panels, {.camera_blur_px = 0.7, .seed = 5});
  }

  [[nodiscard]] DecodeResult decode(int u, int v) const {
    const double z = static_cast<double>(simulation.truth.range.z(v, u));
    const Anchor anchor{.u_px = static_cast<double>(u), .v_px = static_cast<double>(v), .z = z};
    return Decoder(rig, sinusoid(Axis::y), {}, {.anchors = {anchor}}).decode(simulation.frames[0]);
  }
};

// A step by one period of the sinusoid, which lies across the baseline, is 60 mm deep. With one
// anchor on the wall, 30 and 38 % of the depths were wrong, those of the strips.
TEST(AnchoredRegions, GiveNoDepthsOfSeveralSurfacesIfTheSinusoidHardlyShowsSteps) {
  for (const double degrees : {75.0, -75.0}) {
    const View view(degrees, {board(720, 900, 700), board(620, 50, 260, {-60, 0}),
                              board(620, 50, 260, {70, 0})});
    for (const int u : {53, 480}) {
      const DecodeResult result = view.decode(u, 240);
      EXPECT_EQ((result.range.z > 0).count(), 0) << degrees << ' ' << u;
      EXPECT_GE(count(result.reasons, Reason::ambiguous_offset), 20000) << degrees << ' ' << u;
    }
  }
}

TEST(AnchoredRegions, KeepASingleSurfaceIfTheSinusoidHardlyShowsSteps) {
  for (const double degrees : {62.0, -75.0}) {
    Body relief = board(690, 900, 700);
    relief.mesh = geometry::test::height_field(
        120, 90, 6, [](double x, double y) { return 5 * std::sin(x / 40) * std::cos(y / 30); });
    relief.mesh.vertices.colwise() += Eigen::Vector3d(-360, -270, 690);
    const View view(degrees, {relief});
    const DecodeResult result = view.decode(320, 240);
    const geometry::ImageF& truth = view.simulation.truth.range.z;
    const auto right = (result.range.z - truth).abs() < 15;  // a quarter of a period
    EXPECT_GE(static_cast<double>(right.count()), 0.95 * static_cast<double>(truth.size()));
    EXPECT_EQ((result.range.z > 0).count(), right.count());
  }
}

// A pixel beside a dark groove may be on another surface than the groove.
TEST(AnchoredRegions, TakeNoAnchorThatIsFarFromAllOfThem) {
  const Rig rig = make_rig(false);
  Scene scene = render(rig, sinusoid(Axis::y), plane({0, 0, 1}, 720));
  scene.frame.rowRange(100, 114).setTo(cv::Scalar::all(0));
  const auto depths = [&](int row) {
    const Decoder decoder(rig, sinusoid(Axis::y), {}, {.anchors = {anchor_at(scene, 160, row)}});
    return (decoder.decode(scene.frame).range.z > 0).count();
  };
  EXPECT_GE(depths(97), 5000);
  EXPECT_EQ(depths(106), 0);
}

}  // namespace
}  // namespace palpate::sensing
