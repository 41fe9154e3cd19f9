// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/strip_model.h"

#include <gmock/gmock.h>

#include "haptics_testing.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

/// The sheet of strip_acquisition.h.
StripModel sheet() {
  const palpate::support::Strip strip;
  StripModel model;
  model.low_support = -strip.support;
  model.high_support = strip.support;
  model.tension = strip.tension;
  model.axial_stiffness = strip.axial;
  model.lateral_stiffness = strip.lateral;
  model.compliance = strip.compliance;
  model.curvature = -strip.taper / (75 * 75);
  return model;
}

probing::Contact contact_at(double x, double y) {
  return {1, palpate::support::strip_surface(x, y),
          -palpate::support::strip_frame(x, y).row(2).transpose()};
}

TEST(StripModel, MovesAsTheSheetThatWasMeasured) {
  constexpr double kTol = 1e-7;  // [mm] of the two searches for an equilibrium
  for (const auto& truth : palpate::support::strip_truths(palpate::support::Strip{},
                                                          {{-42, -60}, {3, 11}, {28, 40}}, 30)) {
    const probing::Contact contact = contact_at(truth.contact.x(), truth.contact.y());
    EXPECT_LT((displacement(sheet(), contact, truth.force) - truth.displacement).norm(), kTol);
    EXPECT_LT((force(sheet(), contact, truth.displacement) - truth.force).norm(), kTol);
  }
}

TEST(StripModel, IsConservative) {
  constexpr double kStep = 1e-4;  // [mm]
  constexpr double kTol = 1e-6;   // of second differences of energies near 10 N mm
  const probing::Contact contact = contact_at(-21, 20);
  for (const bool skin : {true, false}) {
    StripModel model = sheet();
    if (!skin) model.compliance = 0;
    const Eigen::Vector3d at(0.8, -2.3, 9.1);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(k);
      EXPECT_NEAR(
          (potential(model, contact, at + d) - potential(model, contact, at - d)) / (2 * kStep),
          force(model, contact, at)[k], kTol);
      const Eigen::Vector3d column =
          (force(model, contact, at + d) - force(model, contact, at - d)) / (2 * kStep);
      EXPECT_LT((column - stiffness(model, contact, at).col(k)).norm(), kTol);
    }
  }
}

TEST(StripModel, RestsWithoutForceAndEnergy) {
  const probing::Contact contact = contact_at(7, 0);
  EXPECT_LT(force(sheet(), contact, Eigen::Vector3d::Zero()).norm(), 1e-15);
  EXPECT_EQ(potential(sheet(), contact, Eigen::Vector3d::Zero()), 0);
}

TEST(StripModel, GivesAtSmallDisplacementsTheStringsStiffness) {
  StripModel model = sheet();
  model.compliance = model.curvature = model.lateral_stiffness = 0;
  const Eigen::Matrix3d k = stiffness(model, {1, {20, 0, 0}, {0, 0, -1}}, Eigen::Vector3d::Zero());
  EXPECT_NEAR(k(2, 2), 0.8 * (1 / 70.0 + 1 / 30.0), 1e-14);
  EXPECT_NEAR(k(0, 0), 42 * (1 / 70.0 + 1 / 30.0), 1e-12);
}

TEST(StripModel, RefusesContactsBeyondTheSupportsAndNumbersOutOfRange) {
  const Eigen::Vector3d pressed(0, 0, 1);
  EXPECT_THAT(refusal([&] { return force(sheet(), contact_at(51, 0), pressed); }),
              HasSubstr("between the supports"));
  StripModel model = sheet();
  model.compliance = -1;
  EXPECT_THAT(refusal([&] { return force(model, contact_at(0, 0), pressed); }),
              HasSubstr("compliance"));
  EXPECT_THAT(refusal([&] {
                return force(sheet(), contact_at(0, 0), {0, std::nan(""), 1});
              }),
              HasSubstr("not finite"));
}

}  // namespace
}  // namespace palpate::haptics
