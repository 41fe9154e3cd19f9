// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/decoder_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/core/error.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr double kAnySensitivity = 1;

/// Single precision: 6e-8, some operations, and the depth over the baseline's share of it.
constexpr double kDepthRounding = 1e-6;

struct Found {
  SurfaceImages surfaces;
  ReasonImage reasons;
  [[nodiscard]] Reason reason(long row, long column) const {
    return static_cast<Reason>(reasons(row, column));
  }
};

Found surfaces_of(const DecoderGeometry& model, const Plane& phase,
                  const ChannelShares& shares = {}, double max_sensitivity = kAnySensitivity) {
  Found found;
  found.reasons.setZero(model.rows(), model.columns());
  model.find_surfaces(phase, shares, max_sensitivity, found.surfaces, found.reasons);
  return found;
}

/// The phase at one depth everywhere; NaN where the projector does not reach it.
Plane phases_at(const DecoderGeometry& model, double z) {
  Plane phase(model.rows(), model.columns());
  for (long row = 0; row < phase.rows(); ++row) {
    for (long column = 0; column < phase.cols(); ++column) {
      phase(row, column) =
          static_cast<float>(model.phase_at_depth(row, column, z).value_or(std::nan("")));
    }
  }
  return phase;
}

Rig rig_with_lenses() {
  Rig rig = make_rig(true);
  rig.camera.distortion = {-0.15, 0.08, 1e-3, -5e-4, 0, 0, 0, 0};
  rig.projector.distortion = {-0.2, 0.15, 2e-3, -3e-3, -0.05, 0.02, 0.01, 0.005};
  return rig;
}

TEST(DecoderGeometry, PhaseAndDepthUndoEachOther) {
  for (const Rig& rig : {make_rig(false), make_rig(true), rig_with_lenses()}) {
    for (const Axis axis : {Axis::x, Axis::y}) {
      const DecoderGeometry model(rig, make_pattern(axis, 10, axis == Axis::y ? 1024 : 768));
      for (const double z : {600.0, 900.0}) {
        const Plane phase = phases_at(model, z);
        const Found found = surfaces_of(model, phase);
        long lit = 0;
        for (long i = 0; i < phase.size(); ++i) {
          if (std::isnan(phase.data()[i])) {
            EXPECT_EQ(found.reasons.data()[i], static_cast<int>(Reason::off_panel));
            continue;
          }
          ++lit;
          EXPECT_NEAR(static_cast<double>(found.surfaces.z.data()[i]), z, kDepthRounding * z);
        }
        EXPECT_GT(lit, 10000);
      }
    }
  }
}

TEST(DecoderGeometry, DepthsAndStripePixelsAreThoseOfTheExactTriangulation) {
  for (const Rig& rig : {make_rig(true), rig_with_lenses()}) {
    const Pattern pattern = make_pattern(Axis::y, 10, 1024);
    const DecoderGeometry model(rig, pattern);
    const Triangulation exact(rig);
    Plane phase = phases_at(model, 700);
    for (long i = 0; i < phase.size(); ++i) phase.data()[i] += static_cast<float>(i % 101) - 50;
    const Found found = surfaces_of(model, phase);
    long lit = 0;
    for (long row = 0; row < phase.rows(); ++row) {
      for (long column = 0; column < phase.cols(); ++column) {
        if (found.reason(row, column) != Reason::reconstructed) continue;
        ++lit;
        const double pixel = (static_cast<double>(phase(row, column)) +
                              model.carrier().along * static_cast<double>(row) - pattern.phase) *
                             pattern.period / (2 * std::numbers::pi);
        const Eigen::Vector3d ray = exact.direction(geometry::undistort(
            rig.camera, {static_cast<double>(column), static_cast<double>(row)}));
        const double z = exact.depth(ray, Axis::y, pixel);
        EXPECT_NEAR(static_cast<double>(found.surfaces.z(row, column)), z, kDepthRounding * z);
        EXPECT_NEAR(static_cast<double>(found.surfaces.stripe_pixel(row, column)),
                    exact.project(ray, z).x(), 1e-3);
      }
    }
    EXPECT_GT(lit, 30000);
  }
}

TEST(DecoderGeometry, SensitivityIsTheDerivativeOfTheDepth) {
  for (const Rig& rig : {make_rig(true), rig_with_lenses()}) {
    const DecoderGeometry model(rig, make_pattern(Axis::y, 10, 1024));
    const Plane phase = phases_at(model, 700);
    constexpr float kStep = 1;  // rad; the depth's curvature over it is some 0.4 %
    const Found before = surfaces_of(model, phase - kStep);
    const Found after = surfaces_of(model, phase + kStep);
    const Found here = surfaces_of(model, phase);
    for (const long row : {30L, 120L, 200L}) {
      for (const long column : {60L, 160L, 250L}) {
        const float slope =
            (after.surfaces.z(row, column) - before.surfaces.z(row, column)) / (2 * kStep);
        EXPECT_NEAR(here.surfaces.z_per_phase(row, column) / std::abs(slope), 1, 1e-3);
      }
    }
  }
}

TEST(DecoderGeometry, AStripeEdgeIsWhereItsProjectorPixelIsSeen) {
  for (const Rig& rig : {make_rig(true), rig_with_lenses()}) {
    for (const Axis axis : {Axis::x, Axis::y}) {
      const Pattern pattern = make_pattern(axis, 10, axis == Axis::y ? 1024 : 768);
      const DecoderGeometry model(rig, pattern);
      std::vector<Transition> transitions;  // more than are worked on at once
      for (int edge = 8; edge < 22; ++edge) {
        for (int row = 60; row < 160; ++row) transitions.push_back({row, 150.2F, edge, 1.5F});
      }
      std::vector<PhaseGuess> guesses(3);
      model.phases_at_edges(transitions, guesses);
      ASSERT_GT(guesses.size(), 300U);
      for (const PhaseGuess& guess : guesses) {
        EXPECT_EQ(guess.column, 150);
        EXPECT_EQ(guess.score, 1.5);
        Plane phase = Plane::Constant(model.rows(), model.columns(), std::nanf(""));
        phase(guess.row, 150) = static_cast<float>(guess.phase);
        if (guess.row % 20 != 0) continue;
        EXPECT_NEAR(
            static_cast<double>(surfaces_of(model, phase).surfaces.stripe_pixel(guess.row, 150)),
            pattern.stripe_edges[static_cast<std::size_t>(guess.edge)], 2e-3);
      }
    }
  }
}

TEST(DecoderGeometry, TheLagOfTheTrueDepthReplacesThatOfTheExpectedOne) {
  Rig rig = make_rig(false);
  rig.red = {.alpha = 1, .beta = 1.004, .gamma = 3e-4};
  const DecoderGeometry model(rig, make_pattern(Axis::y, 10, 1024));
  // A sum that is all red: its phase, compensated at the expected pixel, is off by slope times the
  // difference of the pixels.
  const Plane one = Plane::Ones(model.rows(), model.columns());
  const ChannelShares all_red{one, 0 * one};
  const Plane green = phases_at(model, 640);
  const ChannelModel& red = model.chromatic().channels[0];
  const double expected = static_cast<double>(model.chromatic().expected_pixel(100, 100));
  const Pattern& pattern = model.pattern();
  const double pixel =
      (static_cast<double>(green(100, 100)) + model.carrier().along * 100 - pattern.phase) *
      pattern.period / (2 * std::numbers::pi);
  const auto moved = static_cast<float>(red.lag.at(pixel) - red.lag.at(expected));
  const float corrected = surfaces_of(model, green - moved, all_red).surfaces.z(100, 100);
  const float uncorrected = surfaces_of(model, green - moved).surfaces.z(100, 100);
  // Second order in the lag's slope: 0.004^2 of about 150 px between the two depths, 2 mm a px.
  EXPECT_NEAR(corrected, 640, 0.006);
  EXPECT_GT(std::abs(uncorrected - 640), 0.05F);
}

TEST(DecoderGeometry, APhaseThatSaysTooLittleOfTheDepthIsGrazing) {
  const DecoderGeometry model(make_rig(false), make_pattern(Axis::y, 10, 1024));
  const Plane phase = phases_at(model, 700);
  // dz / dphase = (z + t_z)^2 / (f |t_y|) * period / 2 pi = 2.97 mm here, 0.0042 of z.
  EXPECT_EQ(surfaces_of(model, phase, {}, 0.005).reason(120, 100), Reason::reconstructed);
  const Found found = surfaces_of(model, phase, {}, 0.003);
  EXPECT_EQ(found.reason(120, 100), Reason::grazing);
  EXPECT_TRUE(std::isnan(found.surfaces.z(120, 100)));
}

TEST(DecoderGeometry, APhaseOfNoPixelOfThePanelIsTold) {
  const DecoderGeometry model(make_rig(false), make_pattern(Axis::y, 10, 1024));
  EXPECT_FALSE(model.phase_at_depth(120, 100, 150));
  for (const float phase : {-1e4F, 1e30F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    const Found found = surfaces_of(model, Plane::Constant(model.rows(), model.columns(), phase));
    EXPECT_EQ(count(found.reasons, Reason::off_panel), found.reasons.size()) << phase;
    EXPECT_TRUE(found.surfaces.z.isNaN().all());
  }
}

TEST(DecoderGeometry, AnEarlierReasonStays) {
  const DecoderGeometry model(make_rig(false), make_pattern(Axis::y, 10, 1024));
  Found found;
  found.reasons.setConstant(model.rows(), model.columns(), static_cast<int>(Reason::border));
  model.find_surfaces(Plane::Constant(model.rows(), model.columns(), std::nanf("")), {},
                      kAnySensitivity, found.surfaces, found.reasons);
  EXPECT_EQ(count(found.reasons, Reason::border), found.reasons.size());
}

TEST(DecoderGeometry, WrongRigsAndPatternsAreRefused) {
  Rig rig = make_rig(false);
  rig.camera.fx = -1;
  EXPECT_THROW(DecoderGeometry(rig, make_pattern(Axis::y, 10, 1024)), InvalidInput);
  EXPECT_THROW(DecoderGeometry(make_rig(false), make_pattern(Axis::y, -10, 1024)), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
