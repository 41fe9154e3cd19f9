// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_trials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <set>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/fingerprint.h"
#include "palpate/probing/specimen_file.h"
#include "refusal.h"
#include "specimen/weak_specimen.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// The tangential over the normal part of a force, over the coefficient of friction.
double share_of_cone(const Vector3d& force, const FrictionCone& cone) {
  const double along = force.dot(cone.axis);
  return (force - along * cone.axis).norm() / along / cone.coefficient;
}

double pressing_part(const Vector3d& force, const Contact& contact) {
  return -force.dot(contact.normal.normalized());
}

ContactPlan specimen_plan(const Specimen& specimen, int contacts) {
  return plan_contacts(specimen.surface(), {.spacing = 20, .contacts = contacts});
}

TEST(SpecimenTrials, AreExactAndEncloseTheFrictionCone) {
  const auto specimen = make_specimen(ElasticBody{.friction = 0.4});
  const ContactPlan plan = specimen_plan(*specimen, 3);
  const SpecimenTrials made = try_specimen(*specimen, plan);
  EXPECT_TRUE(made.failed.empty());
  EXPECT_EQ(made.equilibria, 3 * 5 * (1 + 4));
  const CheckedAcquisition checked(made.acquisition);
  ASSERT_EQ(checked.contacts().size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    const Contact& contact = checked.contacts()[c];
    const FrictionCone cone = specimen->friction_cone(contact.position);
    std::map<long long, double> levels;
    std::set<double> shares_held;
    for (const Sample& sample : checked.samples_of(c)) {
      const double normal = pressing_part(sample.force, contact);
      levels.emplace(sample.group, normal);
      EXPECT_NEAR(levels.at(sample.group), normal, 1e-9);
      const Vector3d pressed = -normal * contact.normal.normalized();
      EXPECT_LT(
          (sample.a - contact.position - specimen->displacement(contact.position, pressed)).norm(),
          1e-9);
      const double share = share_of_cone(sample.force, cone);
      if (sample.slipped) {
        EXPECT_NEAR(share, 1.02, 1e-4);
        continue;
      }
      EXPECT_LT(
          (sample.b - contact.position - specimen->displacement(contact.position, sample.force))
              .norm(),
          1e-12);
      EXPECT_LE(sample.force.norm(), plan.options.max_force + 1e-9);
      EXPECT_NEAR(share, sample.on_friction_boundary ? 0.98 : 0.55 * 0.98, 1e-4);
    }
    ASSERT_EQ(levels.size(), 5U);
    EXPECT_NEAR(levels.begin()->second, 0.15, 1e-9);
    EXPECT_NEAR(levels.rbegin()->second, 2.6, 1e-9);
  }
}

TEST(SpecimenTrials, DoNotExceedTheMostForceWhereFrictionHoldsMore) {
  const auto specimen = make_specimen(ElasticBody{.friction = 3});
  const ContactPlan plan = specimen_plan(*specimen, 1);
  double largest = 0;
  for (const Sample& sample : try_specimen(*specimen, plan).acquisition.samples)
    if (!sample.slipped) largest = std::max(largest, sample.force.norm());
  EXPECT_NEAR(largest, 3, 1e-9);
}

TEST(SpecimenTrials, OfAnObjectWithoutFrictionPressOnly) {
  const auto specimen = make_specimen(ElasticBody{.friction = 0});
  const SpecimenTrials made = try_specimen(*specimen, specimen_plan(*specimen, 2));
  EXPECT_EQ(made.acquisition.samples.size(), 2U * 5U);
  for (const Sample& sample : made.acquisition.samples) EXPECT_EQ(sample.a, sample.b);
}

TEST(SpecimenTrials, NameTheContactAndTheForceThatFailAndKeepTheOthers) {
  const auto whole = make_specimen(ElasticBody{});
  const ContactPlan plan = specimen_plan(*whole, 4);
  const Vector3d weak = plan.contacts[2].position;
  const support::WeakSpecimen specimen(make_specimen(ElasticBody{}), [&](const Vector3d& place) {
    return (place - weak).norm() < 1e-9 ? 1.5 : 10.0;
  });
  int last = 0, total = 0;
  const SpecimenTrials made = try_specimen(specimen, plan, {.progress = [&](int done, int all) {
                                             EXPECT_GT(done, last);
                                             last = done;
                                             total = all;
                                           }});
  EXPECT_EQ(last, total);
  EXPECT_EQ(made.acquisition.contacts.size(), 4U);
  ASSERT_FALSE(made.failed.empty());
  int not_tried = 0;
  for (const FailedTrial& one : made.failed) {
    EXPECT_EQ(one.contact, plan.contacts[2].id);
    EXPECT_EQ(one.trial.contact, weak);
    EXPECT_GT(one.trial.force.norm(), 1.5);
    EXPECT_EQ(one.trial.reason, "the object is too weak");
    not_tried += one.not_tried;
  }
  // The levels are 0.15, 0.58, 1.18, 1.86 and 2.6 N: with the fourth, its own drags and those of
  // the fifth, with its press, are left out.
  EXPECT_EQ(made.failed.back().not_tried, 4 + 5);
  EXPECT_EQ(not_tried, 4 + 5);
  EXPECT_EQ(made.equilibria, total - not_tried);
  for (const Sample& sample : made.acquisition.samples) {
    if (sample.contact != plan.contacts[2].id || sample.slipped) continue;
    EXPECT_LE(sample.force.norm(), 1.5);
  }
}

TEST(SpecimenTrials, LeaveOutAContactWithoutSamplesAndFailWithoutAny) {
  const auto whole = make_specimen(ElasticBody{});
  const ContactPlan plan = specimen_plan(*whole, 3);
  const support::WeakSpecimen half(make_specimen(ElasticBody{}), [&](const Vector3d& place) {
    return (place - plan.contacts[0].position).norm() < 1e-9 ? 0.0 : 10.0;
  });
  const SpecimenTrials made = try_specimen(half, plan);
  ASSERT_EQ(made.acquisition.contacts.size(), 2U);
  EXPECT_EQ(made.acquisition.contacts[0].id, plan.contacts[1].id);
  const support::WeakSpecimen none(make_specimen(ElasticBody{}),
                                   [](const Vector3d&) { return 0.0; });
  EXPECT_THAT([&] { (void)try_specimen(none, plan); },
              ThrowsMessage<SolverError>(HasSubstr(
                  "no contact has an equilibrium; at the first, the object is too weak")));
  EXPECT_THAT(refusal([&] { return try_specimen(none, ContactPlan{}); }), HasSubstr("no contact"));
}

TEST(SpecimenTrials, OfFiniteElementsDoNotDependOnTheNumberOfThreads) {
  const auto block = parse_specimen(
      R"({"type": "finite_elements", "size": [40, 40, 15], "cells": [4, 4, 2],
          "shear_modulus": 0.03, "friction": 0.6})",
      "");
  const ContactPlan plan = plan_contacts(
      block->surface(), {.spacing = 12, .contacts = 3, .highest_force = 1, .directions = 1});
  ASSERT_EQ(plan.contacts.size(), 3U);
  std::vector<std::string> results;
  for (const std::size_t number : {1U, 4U}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, number);
    results.push_back(fingerprint(try_specimen(*block, plan).acquisition));
  }
  EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace palpate::probing
