// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "sensor_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/error.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr double kAnySensitivity = 1;

TEST(SensorModel, PhaseAndDepthUndoEachOther) {
  for (const Axis axis : {Axis::x, Axis::y}) {
    const SensorModel model(make_rig(true), make_pattern(axis, 10, axis == Axis::y ? 1024 : 768));
    const auto phase = model.phase_at_depth(120, 100, 700);
    ASSERT_TRUE(phase);
    const auto surface = model.surface_at(120, 100, *phase, {}, kAnySensitivity);
    EXPECT_NEAR(surface.z, 700, 1e-8);
  }
}

TEST(SensorModel, AStripeEdgeIsWhereItsProjectorPixelIsSeen) {
  const Rig rig = make_rig(true);
  const Pattern pattern = make_pattern(Axis::y, 10, 1024);
  const SensorModel model(rig, pattern);
  const auto phase = model.phase_at_edge(120, 150, 14);
  ASSERT_TRUE(phase);
  const auto surface = model.surface_at(120, 150, *phase, {}, kAnySensitivity);
  EXPECT_NEAR(surface.pixel.x(), pattern.stripe_edges[14], 1e-8);
}

TEST(SensorModel, TheLagOfTheTrueDepthReplacesThatOfTheExpectedOne) {
  Rig rig = make_rig(false);
  rig.red = {.alpha = 1, .beta = 1.004, .gamma = 3e-4};
  const SensorModel model(rig, make_pattern(Axis::y, 10, 1024));
  // A sum that is all red: its phase, compensated at the expected pixel, is off by slope times the
  // difference of the pixels.
  const Plane one = Plane::Ones(model.rows(), model.columns());
  const ChannelShares shares{one, 0 * one};
  const auto green = model.phase_at_depth(100, 100, 640);
  ASSERT_TRUE(green);
  const auto surface = model.surface_at(100, 100, *green, {}, kAnySensitivity);
  const ChannelModel& red = model.chromatic().channels[0];
  const double expected = static_cast<double>(model.chromatic().expected_pixel(100, 100));
  const double compensated = *green - red.lag.at(surface.pixel.y()) + red.lag.at(expected);
  const auto corrected = model.surface_at(100, 100, compensated, shares, kAnySensitivity);
  // Second order in the lag's slope: 0.004^2 of about 150 px between the two depths, 2 mm a px.
  EXPECT_NEAR(corrected.z, 640, 0.006);
  EXPECT_GT(std::abs(model.surface_at(100, 100, compensated, {}, kAnySensitivity).z - 640), 0.05);
}

TEST(SensorModel, APhaseThatSaysTooLittleOfTheDepthIsGrazing) {
  const SensorModel model(make_rig(false), make_pattern(Axis::y, 10, 1024));
  const auto phase = model.phase_at_depth(120, 100, 700);
  ASSERT_TRUE(phase);
  // dz / dphase = (z + t_z)^2 / (f |t_y|) * period / 2 pi = 2.97 mm here, 0.0042 of z.
  EXPECT_EQ(model.surface_at(120, 100, *phase, {}, 0.005).reason, Reason::reconstructed);
  EXPECT_EQ(model.surface_at(120, 100, *phase, {}, 0.003).reason, Reason::grazing);
}

TEST(SensorModel, APhaseOfNoPixelOfThePanelIsTold) {
  const SensorModel model(make_rig(false), make_pattern(Axis::y, 10, 1024));
  EXPECT_FALSE(model.phase_at_depth(120, 100, 150));
  for (const double phase : {-1e4, std::nan("")}) {
    EXPECT_EQ(model.surface_at(120, 100, phase, {}, kAnySensitivity).reason, Reason::off_panel);
  }
}

TEST(SensorModel, WrongRigsAndPatternsAreRefused) {
  Rig rig = make_rig(false);
  rig.camera.fx = -1;
  EXPECT_THROW(SensorModel(rig, make_pattern(Axis::y, 10, 1024)), InvalidInput);
  EXPECT_THROW(SensorModel(make_rig(false), make_pattern(Axis::y, -10, 1024)), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
