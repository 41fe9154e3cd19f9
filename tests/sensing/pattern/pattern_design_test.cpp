// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/core/error.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

/// Shortest distance in the camera between neighbouring crests of the sinusoid on a plane z =
/// const, along the image's columns: found from the geometry alone.
double shortest_period(const Rig& rig, const Pattern& pattern, double z) {
  double shortest = std::numeric_limits<double>::infinity();
  const auto pixel = [&](double u, double v) {
    const Eigen::Vector3d ray = geometry::undistort(rig.camera, {u, v}).homogeneous();
    return geometry::distort(rig.projector, (rig.T_projector_camera * (z * ray)).hnormalized()).y();
  };
  for (int u = 5; u < rig.camera.width; u += 25) {
    for (int v = 5; v < rig.camera.height; v += 5) {
      shortest = std::min(shortest, pattern.period / (pixel(u, v + 0.5) - pixel(u, v - 0.5)));
    }
  }
  return shortest;
}

TEST(PatternDesign, MakesTheThesisPattern) {
  const PatternDesign design = design_pattern(make_rig(false));
  EXPECT_EQ(design.pattern.stripes.size(), 31U);
  EXPECT_EQ(design.pattern.colors.size(), 6U);
  EXPECT_EQ(design.pattern.axis, Axis::y);  // its baseline is longer along y
  // All of the panel, in stripes whose widths differ by a pixel at most, edges between pixels.
  ASSERT_EQ(design.pattern.stripe_edges.size(), 30U);
  double before = -0.5;
  for (const double edge : design.pattern.stripe_edges) {
    EXPECT_NEAR(edge - before, 1024.0 / 31, 1);
    EXPECT_EQ(edge - std::floor(edge), 0.5);
    before = edge;
  }
  EXPECT_NEAR(1023.5 - before, 1024.0 / 31, 1);
}

TEST(PatternDesign, KeepsThePeriodAboveTheCamerasLimitOverTheWholeRange) {
  for (const bool verging : {false, true}) {
    const Rig rig = make_rig(verging);
    for (const double least : {4.0, 7.0, 9.5}) {
      const PatternDesign design = design_pattern(
          rig, {.axis = Axis::y, .range = WorkingRange{500, 1200}, .min_camera_period = least});
      double shortest = std::numeric_limits<double>::infinity();
      for (const double z : {500.0, 700.0, 1200.0})
        shortest = std::min(shortest, shortest_period(rig, design.pattern, z));
      EXPECT_GE(shortest, least * (verging ? 0.99 : 1));  // it samples places some way apart
      EXPECT_EQ(design.pattern.period, std::round(design.pattern.period));
      // One pixel less would be too short.
      EXPECT_LT(shortest * (design.pattern.period - 1) / design.pattern.period,
                least * (verging ? 1.06 : 1));
      EXPECT_GE(design.camera_period, least);
    }
  }
}

TEST(PatternDesign, KeepsThePeriodAboveTheProjectorsLimit) {
  Rig rig = make_rig(false);
  rig.camera.fx = rig.camera.fy = 5000;  // a camera that sees every pixel of the projector
  EXPECT_EQ(design_pattern(rig).pattern.period, 8);
  EXPECT_EQ(design_pattern(rig, {.min_projector_period = 12}).pattern.period, 12);
  EXPECT_EQ(design_pattern(rig, {.period = 9.25}).pattern.period, 9.25);
}

TEST(PatternDesign, PredictsThePhaseOfADepthAndTheToleranceOfEdges) {
  const Rig rig = make_rig(false);
  const PatternDesign design = design_pattern(rig, {.range = WorkingRange{700, 700}});
  // Eq. 3.10: pixel = f (y z + t_y) / (z + t_z), whose derivative by z varies little over the
  // image.
  const double z = 700;
  const double per_depth = 1500 * 165 / ((z - 20) * (z - 20));
  const double phase = 2 * std::numbers::pi / design.pattern.period * per_depth * z;
  EXPECT_NEAR(design.phase_per_relative_depth, phase, 0.05 * phase);
  // Half a period is as much depth as 150 / 165 of it across; a camera pixel is 1500 / 550 of it.
  const double tolerance = design.pattern.period / 2 * 150 / 165 / (1500.0 / 550 * z / (z - 20));
  EXPECT_NEAR(design.edge_tolerance, tolerance, 0.1 * tolerance);
}

TEST(PatternDesign, TakesTheAxisAlongWhichDepthMovesThePatternMore) {
  Rig rig = make_rig(false);
  rig.T_projector_camera.translation() = Eigen::Vector3d(180, 40, -20);
  const PatternDesign design = design_pattern(rig);
  EXPECT_EQ(design.pattern.axis, Axis::x);
  EXPECT_NEAR(design.pattern.stripe_edges.back(), 768.0 * 30 / 31 - 0.5, 0.5);  // along y
  EXPECT_EQ(design_pattern(rig, {.axis = Axis::y}).pattern.axis, Axis::y);
  rig.T_projector_camera.translation() = Eigen::Vector3d(180, 0, 0);
  const std::string message =
      message_of<InvalidInput>([&] { (void)design_pattern(rig, {.axis = Axis::y}); });
  EXPECT_NE(message.find("take x"), std::string::npos);
}

TEST(PatternDesign, WithoutARigFillsThePanel) {
  const PatternDesign design = design_pattern(800, 600, {.number_of_colors = 4, .stripes = 10});
  EXPECT_EQ(design.pattern.stripes.size(), 10U);
  EXPECT_EQ(design.pattern.stripe_edges[0], 79.5);
  EXPECT_EQ(design.pattern.period, 10);
  EXPECT_EQ(design.pattern.axis, Axis::y);
}

TEST(PatternDesign, RefusesWhatCannotBe) {
  const Rig rig = make_rig(false);
  const auto refusal_of = [&](const PatternOptions& options) {
    return message_of<InvalidInput>([&] { (void)design_pattern(rig, options); });
  };
  EXPECT_THAT(refusal_of({.number_of_colors = 1}), HasSubstr("in [2, 24]"));
  EXPECT_THAT(refusal_of({.stripes = 32}), HasSubstr("2 to 31"));
  EXPECT_THAT(refusal_of({.stripes = 0}), HasSubstr("stripes is 0; it must be >= 2"));
  EXPECT_THAT(refusal_of({.number_of_colors = 20}), HasSubstr("narrower than 4"));
  EXPECT_THAT(refusal_of({.range = WorkingRange{900, 500}}),
              HasSubstr("range.far is 500 mm; it must be >= 900"));
  EXPECT_THAT(refusal_of({.range = WorkingRange{1, 2}}), HasSubstr("lights nothing"));
  EXPECT_THAT(refusal_of({.min_camera_period = 1.9}), HasSubstr("min_camera_period"));
  EXPECT_THAT(refusal_of({.min_projector_period = NAN}), HasSubstr("min_projector_period"));
  EXPECT_THAT(refusal_of({.period = 1.0}), HasSubstr("period"));
  EXPECT_THAT(refusal_of({.mean = 0.7}), HasSubstr("amplitude"));
  EXPECT_NE(message_of<InvalidInput>([] {
              (void)design_pattern(0, 600);
            }).find("projector_width is 0 px"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
