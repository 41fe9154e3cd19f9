// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "sample_arrows.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sheet_model.h"

namespace palpate::view {
namespace {

/// Presses and drags at the four contacts of the sheet, whose forces are those of its springs and
/// `error` [N] more along y.
probing::CheckedAcquisition measured(double error) {
  const haptics::Model model = haptics::sheet_model();
  probing::Acquisition acquisition;
  long long id = 0;
  for (const haptics::ContactModel& contact : model.contacts) {
    acquisition.contacts.push_back(
        {.id = contact.id, .position = contact.position, .normal = {0, 0, -1}});
    const Eigen::Vector3d pressed(0, 0, 3), dragged(0.5, 0, 3);
    const double depth = dragged.norm();
    const Eigen::Vector3d force = 4 / std::sqrt(depth * depth + 100) * dragged;
    acquisition.samples.push_back({.id = id++,
                                   .contact = contact.id,
                                   .group = 0,
                                   .force = force + Eigen::Vector3d(0, error, 0),
                                   .a = contact.position + pressed,
                                   .b = contact.position + dragged});
  }
  return acquisition;
}

TEST(SampleArrows, EndWhereTheToolWas) {
  const std::vector<SampleArrow> arrows = sample_arrows(measured(0), nullptr);
  ASSERT_EQ(arrows.size(), 8u) << "a pressed and a dragged pair of each contact";
  EXPECT_EQ(arrows[0].kind, haptics::PairKind::settled);
  EXPECT_NEAR((arrows[1].tool - Eigen::Vector3d(-29.5, -30, 703)).norm(), 0, 1e-9);
  EXPECT_FALSE(arrows[1].residual.has_value());
  EXPECT_FALSE(residual_rms(arrows).has_value());
}

TEST(SampleArrows, DifferFromTheModelByTheirErrors) {
  const haptics::Model model = haptics::sheet_model();
  const auto residual = [&](double error) {
    return *sample_arrows(measured(error), &model)[1].residual;
  };
  EXPECT_NEAR(residual(0), 0, 1e-9);
  EXPECT_NEAR(residual(0.2), 0.2, 1e-9);
  EXPECT_NEAR(residual(-0.3), 0.3, 1e-9);
}

TEST(SampleArrows, AreComparedInTheFrameOfTheModel) {
  // The model was moved onto another surface: turned about z, and shifted.
  haptics::Model model = haptics::sheet_model();
  model.T_surface_acquisition =
      Eigen::Translation3d(5, 6, 7) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ());
  model.surface.vertices = (model.T_surface_acquisition * model.surface.vertices).eval();
  for (haptics::ContactModel& contact : model.contacts) {
    contact.position = model.T_surface_acquisition * contact.position;
    contact.frame = model.T_surface_acquisition.linear() * contact.frame;
  }
  EXPECT_NEAR(*sample_arrows(measured(0.2), &model)[1].residual, 0.2, 1e-9);
}

TEST(SampleArrows, HaveNoResidualAtContactsThatTheModelDoesNotHave) {
  haptics::Model model = haptics::sheet_model();
  model.contacts[0].id = 999;
  const std::vector<SampleArrow> arrows = sample_arrows(measured(0.2), &model);
  EXPECT_FALSE(arrows[0].residual.has_value());
  EXPECT_TRUE(arrows[2].residual.has_value());
}

}  // namespace
}  // namespace palpate::view
