// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

// Presses against the z axis; a drag keeps the position before it in `a`.
Sample press_sample(long long contact, double force, double depth, double across = 0) {
  static long long next = 0;
  return {.id = next++,
          .contact = contact,
          .force = {across, 0, -force},
          .a = Vector3d(10.0 * static_cast<double>(contact), 0, -depth),
          .b = Vector3d(10.0 * static_cast<double>(contact) + across, 0, -depth)};
}

Acquisition at_contacts(int count) {
  Acquisition acquisition;
  for (int i = 0; i < count; ++i)
    acquisition.contacts.push_back({i, Vector3d(10.0 * i, 0, 0), Vector3d::UnitZ()});
  return acquisition;
}

TEST(ContactStiffness, IsTheForceOverTheDepthAtThatForce) {
  Acquisition acquisition = at_contacts(1);
  // Hertz: depth = (force / c)^(2/3); at 1 N it was pressed.
  for (const double force : {0.5, 1.0, 2.0})
    acquisition.samples.push_back(press_sample(0, force, std::pow(force / 0.4, 2.0 / 3)));
  const std::vector<ContactStiffness> found = contact_stiffness(acquisition, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].stiffness, std::pow(0.4, 2.0 / 3), 1e-12);
  EXPECT_EQ(found[0].position, Vector3d::Zero());
}

TEST(ContactStiffness, LiesBetweenThePressesBelowAndAboveTheForce) {
  Acquisition acquisition = at_contacts(2);
  acquisition.samples = {press_sample(0, 1, 2), press_sample(0, 2, 3), press_sample(1, 2, 5)};
  const std::vector<ContactStiffness> found = contact_stiffness(acquisition, 1.5);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].stiffness, 1.5 / 2.5, 1e-12);
  EXPECT_NEAR(found[1].stiffness, 1.5 / 3.75, 1e-12);  // from no force at no depth
}

TEST(ContactStiffness, DragsCountAsThePressBeforeThem) {
  Acquisition acquisition = at_contacts(1);
  acquisition.samples = {press_sample(0, 1, 2, 0.4), press_sample(0, 1, 2.2, -0.3)};
  const std::vector<ContactStiffness> found = contact_stiffness(acquisition, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].stiffness, 1 / 2.1, 1e-12);
}

TEST(ContactStiffness, DeviationIsThatOfRepeatedMeasurements) {
  constexpr double noise = 0.05, force_noise = 0.02, depth = 2, force = 1;
  // A linear contact: an error of the force moves the tip by it times depth / force.
  const double one = std::hypot(noise, force_noise * depth / force);
  Acquisition acquisition = at_contacts(1);
  for (int i = 0; i < 4; ++i) acquisition.samples.push_back(press_sample(0, force, depth));
  const std::vector<ContactStiffness> found =
      contact_stiffness(acquisition, force, {noise, force_noise});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].deviation, force / (depth * depth) * one / 2, 1e-12);
}

TEST(ContactStiffness, LeavesOutContactsThatWereNotPressedSoHardOrGaveNoWay) {
  Acquisition acquisition = at_contacts(4);
  acquisition.samples = {press_sample(0, 0.5, 1), press_sample(1, 1, 0.01),
                         press_sample(2, 1, 2)};  // and contact 3 has none
  const std::vector<ContactStiffness> found = contact_stiffness(acquisition, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].position.x(), 20);
}

TEST(ContactStiffness, TheCommonForceIsOneThatThreeQuartersReach) {
  Acquisition acquisition = at_contacts(8);
  for (int i = 0; i < 8; ++i) {
    acquisition.samples.push_back(press_sample(i, 0.5, 1));
    if (i > 1) acquisition.samples.push_back(press_sample(i, 2, 3));
  }
  EXPECT_EQ(common_press_force(acquisition), 2);
  EXPECT_EQ(contact_stiffness(acquisition, 2).size(), 6U);
  EXPECT_EQ(common_press_force(at_contacts(3)), 0);
}

TEST(ContactStiffness, RefusesForcesAndNoiseThatCannotBe) {
  const Acquisition acquisition = at_contacts(1);
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW((void)contact_stiffness(acquisition, bad), InvalidInput);
    EXPECT_THROW((void)contact_stiffness(acquisition, 1, {.position = bad}), InvalidInput);
  }
  EXPECT_THROW((void)contact_stiffness(acquisition, 1, {.force = -1}), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
