// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "arm/simulated_contact.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

#include "block_specimen.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kStructure = 3.5;  // [N/mm]
constexpr double kTick = 1e-3;      // [s]

/// Moves the tip to a place along a line, in small steps.
std::optional<Vector3d> guide(SimulatedContact& contact, const Vector3d& from, const Vector3d& to) {
  constexpr int kTicks = 200;
  std::optional<Vector3d> force;
  for (std::uint64_t i = 1; i <= kTicks; ++i) {
    const Vector3d tip = from + (to - from) * (static_cast<double>(i) / kTicks);
    contact.find_surface(tip, i);
    force = contact.press(tip);
    contact.settle(kTick);
  }
  return force;
}

TEST(SimulatedContact, PressesAsFarAsTheObjectAndTheArmGiveWay) {
  const support::BlockSpecimen block(0.8);
  SimulatedContact contact(block, kStructure);
  const Vector3d above(0, 0, 1), within(0.3, 0, -1.5);
  EXPECT_FALSE(guide(contact, above, Vector3d(0, 0, 0.01)));
  EXPECT_FALSE(contact.touches());
  const std::optional<Vector3d> force = guide(contact, Vector3d(0, 0, 0.01), within);
  ASSERT_TRUE(force);
  const Vector3d way = block.displacement(contact.place(), *force) + *force / kStructure;
  // The force is that of the linearisation, taken again at changes of 5 %.
  EXPECT_LT((contact.place() + way - within).norm(), 0.01);
  EXPECT_EQ(contact.slid(), 0);
  EXPECT_FALSE(guide(contact, within, above));
  EXPECT_FALSE(contact.touches());
}

TEST(SimulatedContact, SlidesSoThatTheForceStaysOnTheFrictionCone) {
  const support::BlockSpecimen block(0.8, 0.5);
  SimulatedContact contact(block, kStructure);
  const Vector3d pressed(0, 0, -1.5), dragged(4, 0, -1.5);
  ASSERT_TRUE(guide(contact, Vector3d(0, 0, 0.5), pressed));
  const std::optional<Vector3d> force = guide(contact, pressed, dragged);
  ASSERT_TRUE(force);
  EXPECT_NEAR(force->head<2>().norm() / -force->z(), 0.5, 1e-9);
  EXPECT_GT(contact.slid(), 2);
  EXPECT_NEAR(contact.place().x(), contact.slid(), 1e-6);
}

}  // namespace
}  // namespace palpate::probing
