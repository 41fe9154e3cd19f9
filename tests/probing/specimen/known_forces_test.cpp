// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/known_forces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "palpate/probing/closed_form.h"
#include "refusal.h"
#include "specimen/weak_specimen.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

TEST(KnownForces, AreThoseOfTheSpecimenInsideItsConeAndAwayFromItsBorder) {
  const ElasticBody body{.size = 60, .friction = 0.5};
  const auto specimen = make_specimen(body);
  const KnownForces known = known_forces(*specimen, {.queries = 200, .margin = 10, .max_force = 2});
  EXPECT_TRUE(known.unanswered.empty());
  ASSERT_EQ(known.forces.size(), 200U);
  double smallest = 9, largest = 0, steepest = 0;
  for (const KnownForce& one : known.forces) {
    EXPECT_LE(one.contact.head<2>().cwiseAbs().maxCoeff(), 20 + 1e-9);
    EXPECT_EQ(one.displacement, specimen->displacement(one.contact, one.force));
    const FrictionCone cone = specimen->friction_cone(one.contact);
    const double along = one.force.dot(cone.axis);
    steepest = std::max(steepest, (one.force - along * cone.axis).norm() / along);
    smallest = std::min(smallest, one.force.norm());
    largest = std::max(largest, one.force.norm());
  }
  // Of 200 even numbers, the outermost five per cent are not all missing.
  EXPECT_LE(steepest, 0.9 * 0.5 + 1e-9);
  EXPECT_GT(steepest, 0.9 * 0.5 * std::sqrt(0.95));
  EXPECT_GE(smallest, 0.1 - 1e-9);
  EXPECT_LT(smallest, 0.195);
  EXPECT_LE(largest, 2 + 1e-9);
  EXPECT_GT(largest, 1.905);
}

TEST(KnownForces, NamesThoseWithoutAnEquilibriumAndKeepsTheOthers) {
  const support::WeakSpecimen specimen(make_specimen(ElasticBody{}), [](const Vector3d& place) {
    return place.x() > 0 ? 1.0 : 10.0;  // [N]
  });
  int done = 0;
  const KnownForces known =
      known_forces(specimen, {.queries = 60, .progress = [&](int now, int all) {
                                EXPECT_EQ(now, ++done);
                                EXPECT_EQ(all, 60);
                              }});
  EXPECT_EQ(done, 60);
  EXPECT_EQ(known.forces.size() + known.unanswered.size(), 60U);
  EXPECT_GT(known.unanswered.size(), 10U);
  for (const UnansweredForce& one : known.unanswered) {
    EXPECT_GT(one.contact.x(), 0);
    EXPECT_GT(one.force.norm(), 1);
    EXPECT_THAT(one.reason, HasSubstr("too weak"));
  }
  for (const KnownForce& one : known.forces)
    EXPECT_TRUE(one.contact.x() <= 0 || one.force.norm() <= 1);
}

TEST(KnownForces, RefusesAMarginThatLeavesNoPlace) {
  const auto specimen = make_specimen(ElasticBody{.size = 20});
  EXPECT_THAT(refusal([&] { return known_forces(*specimen, {.margin = 12}); }),
              HasSubstr("KnownForceOptions::margin, 12 mm; give a smaller one"));
  EXPECT_TRUE(known_forces(*specimen, {.queries = 0, .margin = 12}).forces.empty());
  EXPECT_THAT(refusal([&] { return known_forces(*specimen, {.max_force = 0.05}); }),
              HasSubstr("KnownForceOptions::max_force"));
}

}  // namespace
}  // namespace palpate::probing
