// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/reference_probe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "campaign/campaign_testing.h"
#include "not_finite.h"
#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

ContactPlan plan_of_one() {
  ContactPlan plan;
  plan.contacts = {{.id = 4, .position = {1, 2, 700}, .normal = {0, 0, -1}}};
  plan.normal_forces = {0.2, 0.5, 1};
  return plan;
}

/// At rest so deep under the reference force.
ReferenceProbe probe_at(long long number, double time, double depth) {
  ReferenceProbe probe{.number = number, .trials = 50 * number, .time = time};
  probe.result.outcome = TrialOutcome::held;
  probe.result.a = Vector3d(1.1, 1.9, 700 + depth);
  return probe;
}

TEST(ReferenceProbe, PressesTheFirstContactWithTheMiddleForce) {
  const TrialOrder order = reference_order(plan_of_one(), 3);
  EXPECT_EQ(order.trial, kFirstReferenceTrial + 3);
  EXPECT_EQ(order.contact.id, 4);
  EXPECT_EQ(order.normal_force, Vector3d(0, 0, 0.5));
  EXPECT_EQ(order.tangential_force, Vector3d::Zero());
  EXPECT_EQ(order.direction, -1);
  EXPECT_THROW((void)reference_order({}, 0), InvalidInput);
}

TEST(ReferenceProbe, DriftIsTheSlopeOfTheDisplacementTimesTheDuration) {
  std::vector<ReferenceProbe> probes;
  for (int i = 0; i < 5; ++i)
    probes.push_back(probe_at(i, 600 * i * i, 2 + 1e-4 * 600 * i * i));  // 0.1 um each second
  probes.push_back(probe_at(5, 10000, 99));
  probes.back().result.outcome = TrialOutcome::unsettled;  // does not count
  const ReferenceDrift drift = reference_drift(probes, plan_of_one());
  EXPECT_EQ(drift.probes, 5);
  EXPECT_NEAR(drift.change, 1e-4 * 9600, 1e-9);
  EXPECT_NEAR(drift.displacement, 2 + 1e-4 * 600 * 6, 1e-9);
}

TEST(ReferenceProbe, TheErrorOfTheDriftIsThatOfRepeatedCampaigns) {
  ProgramOptions options;
  options.position_noise = 0.02;
  options.force_noise = 0.01;  // with 4 mm/N: 0.04 mm
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, std::hypot(0.02, 0.04));
  constexpr int kCampaigns = 2000;
  double squares = 0;
  ReferenceDrift drift;
  for (int campaign = 0; campaign < kCampaigns; ++campaign) {
    std::vector<ReferenceProbe> probes;
    for (int i = 0; i < 6; ++i) probes.push_back(probe_at(i, 500.0 * i, 2 + noise(random)));
    drift = reference_drift(probes, plan_of_one(), options);
    squares += drift.change * drift.change / kCampaigns;
  }
  // The standard deviation of such a standard deviation is 1.6 %; the last displacement, by which
  // the compliance is known, errs by 1 %.
  EXPECT_NEAR(drift.error, std::sqrt(squares), 0.08 * drift.error);
}

TEST(ReferenceProbe, FewerThanThreeProbesTellNoDrift) {
  const std::vector<ReferenceProbe> two = {probe_at(0, 0, 2), probe_at(1, 600, 3)};
  const ReferenceDrift drift = reference_drift(two, plan_of_one());
  EXPECT_EQ(drift.displacement, 2.5);
  EXPECT_TRUE(std::isnan(drift.change));
  const ReferenceDrift none = reference_drift({}, plan_of_one());
  EXPECT_EQ(none.probes, 0);
  EXPECT_TRUE(std::isnan(none.displacement));
  const std::vector<ReferenceProbe> at_once(3, probe_at(0, 5, 2));
  EXPECT_TRUE(std::isnan(reference_drift(at_once, plan_of_one()).change));
}

// The object softens by a third over a campaign: what is measured is what it does.
TEST(ReferenceProbe, ACampaignOnASofteningObjectShowsIt) {
  const ContactPlan plan = support::small_plan(*make_specimen(ElasticBody{}), 1);
  std::vector<ReferenceProbe> probes;
  const Contact& contact = plan.contacts[0];
  Vector3d first = Vector3d::Zero(), last = first;
  for (int i = 0; i < 10; ++i) {
    const std::shared_ptr<const Specimen> body =
        make_specimen(ElasticBody{.young_modulus = 0.05 / (1 + i / 30.0)});
    const auto arm = make_quasi_static_arm(body);
    const TrialOrder order = reference_order(plan, i);
    last = body->displacement(contact.position, order.normal_force);
    if (i == 0) first = last;
    probes.push_back({.number = i, .time = 600.0 * i, .result = run_trial(*arm, order, {})});
  }
  const ReferenceDrift drift = reference_drift(probes, plan);
  const double truth = (first - last).dot(contact.normal);
  EXPECT_GT(truth, 10 * drift.error);
  EXPECT_NEAR(drift.change, truth, 4 * drift.error);
}

}  // namespace
}  // namespace palpate::probing
