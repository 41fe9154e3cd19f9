// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/adaptive_trials.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <memory>
#include <vector>

#include "campaign/campaign_testing.h"
#include "palpate/core/error.h"
#include "palpate/probing/force_surrogate.h"
#include "palpate/probing/known_forces.h"
#include "sticking_ball.h"

namespace palpate::probing {
namespace {

using support::perform;

CampaignOptions adaptive(int most_samples) {
  return {.strategy = TrialStrategy::adaptive, .max_samples = most_samples};
}

ContactPlan plan_of(const Specimen& specimen, int contacts) {
  return plan_contacts(specimen.surface(), {.spacing = 20, .contacts = contacts});
}

struct Ended {
  std::vector<TrialRecord> records;
  CampaignProgress progress;
};

Ended run(const std::shared_ptr<const Specimen>& specimen, int contacts,
          const CampaignOptions& options) {
  Campaign campaign(plan_of(*specimen, contacts), options);
  const auto arm = make_quasi_static_arm(specimen, {.seed = options.seed});
  Ended ended{perform(campaign, *arm, options, 3000), {}};
  EXPECT_FALSE(campaign.next());
  ended.progress = campaign.progress();
  return ended;
}

TEST(AdaptiveTrials, ReplayingItsRecordsGivesTheSameDecisions) {
  const std::shared_ptr<const Specimen> beam = make_specimen(Beam{});
  const CampaignOptions options = adaptive(130);
  const Ended whole = run(beam, 5, options);
  Campaign again(plan_of(*beam, 5), options);
  for (const TrialRecord& record : whole.records) {
    const auto order = again.next();
    ASSERT_TRUE(order);
    EXPECT_EQ(order->normal_force, record.order.normal_force);
    EXPECT_EQ(order->tangential_force, record.order.tangential_force);
    EXPECT_NO_THROW((void)again.take(record));
  }
  EXPECT_FALSE(again.next());
  EXPECT_GT(whole.progress.stated.error, 0);
  EXPECT_EQ(again.progress().stated.error, whole.progress.stated.error);
}

TEST(AdaptiveTrials, EndsAtEachOfItsLimits) {
  const std::shared_ptr<const Specimen> body = make_specimen(ElasticBody{});
  const Ended samples = run(body, 4, adaptive(50));
  EXPECT_EQ(samples.progress.samples, 50);
  EXPECT_EQ(samples.progress.stop, AdaptiveStop::max_samples);
  CampaignOptions options{.strategy = TrialStrategy::adaptive, .max_hours = 0.1};
  const Ended hours = run(body, 4, options);
  EXPECT_EQ(hours.progress.stop, AdaptiveStop::max_hours);
  EXPECT_LE(hours.progress.seconds, 0.1 * 3600 + 15);
  EXPECT_GT(hours.progress.seconds, 0.1 * 3600 - 30);
  options = {.strategy = TrialStrategy::adaptive, .until = 0.03};
  const Ended accurate = run(body, 12, options);
  EXPECT_EQ(accurate.progress.stop, AdaptiveStop::accurate);
  EXPECT_LE(accurate.progress.stated.error, 0.03);
}

// A linear elastic body: the error of a fit can be compared with the truth.
TEST(AdaptiveTrials, PredictsItsSamplesAsWellAsItSays) {
  const std::shared_ptr<const Specimen> body = make_specimen(ElasticBody{});
  const Ended ended = run(body, 5, adaptive(190));
  EXPECT_GT(ended.progress.stated.predictions, 50);
  EXPECT_GT(ended.progress.stated.predicted_over_actual, 0.7);
  EXPECT_LT(ended.progress.stated.predicted_over_actual, 1.4);
}

// A flat body on which the ball sticks: its displacements come from no energy.
class StickingBody : public Specimen {
 public:
  const geometry::TriangleMesh& surface() const override { return body_->surface(); }
  Eigen::Vector3d displacement(const Eigen::Vector3d&,
                               const Eigen::Vector3d& force) const override {
    if (!(force.z() > 0)) throw SolverError("the ball is pulled off");
    return palpate::support::sticking_ball(force);
  }
  FrictionCone friction_cone(const Eigen::Vector3d&) const override {
    return {Eigen::Vector3d::UnitZ(), 0.8};
  }

 private:
  std::unique_ptr<Specimen> body_ = make_specimen(ElasticBody{});
};

// Before any sample was predicted before it was taken, and after many were.
TEST(AdaptiveTrials, StatesTheErrorWhereForcesDependOnThePath) {
  const auto body = std::make_shared<StickingBody>();
  const KnownForces known = known_forces(*body, {.queries = 200});
  for (const int samples : {75, 180}) {
    const Ended ended = run(body, 3, adaptive(samples));
    double squares = 0, queries = 0;
    for (const Contact& contact : plan_of(*body, 3).contacts) {
      std::map<int, ForcePair> pressed;  // by level
      std::vector<ForcePair> pairs;
      for (const auto& [order, result] : ended.records) {
        if (order.contact.id != contact.id || result.outcome != TrialOutcome::held) continue;
        pairs.push_back({order.normal_force + order.tangential_force, result.b - contact.position});
        pressed[order.level] = {order.normal_force, result.a - contact.position};
      }
      for (const auto& [level, pair] : pressed) pairs.push_back(pair);
      const ForceSurrogate surrogate(pairs);
      for (const KnownForce& one : known.forces) {
        const Eigen::Vector3d off = surrogate.predict(one.force).mean - one.displacement;
        squares += (surrogate.compliance(one.force).inverse() * off).squaredNorm();
        ++queries;
      }
    }
    const double ratio = ended.progress.stated.error / std::sqrt(squares / queries);
    EXPECT_GT(ratio, 0.7) << samples;
    EXPECT_LT(ratio, 1.4) << samples;
  }
}

// None of five contacts is enclosed by six others.
TEST(AdaptiveTrials, StatesTheErrorBetweenAFewContactsByHowMuchTheyDiffer) {
  const StatedError alike = run(make_specimen(ElasticBody{}), 5, adaptive(130)).progress.stated;
  const StatedError uneven = run(make_specimen(Sheet{}), 5, adaptive(130)).progress.stated;
  EXPECT_LT(alike.between, 0.5 * alike.at_contacts);
  EXPECT_GT(uneven.between, 2 * uneven.at_contacts);
  for (const StatedError& stated : {alike, uneven})
    EXPECT_NEAR(stated.error, std::hypot(stated.at_contacts, stated.between), 1e-12);
}

TEST(AdaptiveTrials, SaysWhenTheTargetIsOutOfReach) {
  const std::shared_ptr<const Specimen> body = make_specimen(ElasticBody{});
  const CampaignOptions options{.strategy = TrialStrategy::adaptive, .until = 1e-4};
  const Ended ended = run(body, 1, options);
  EXPECT_EQ(ended.progress.stop, AdaptiveStop::exhausted);
  EXPECT_EQ(ended.progress.contacts, 1);
  EXPECT_LE(ended.progress.trials, 61);
}

TEST(AdaptiveTrials, EndsWhereEverythingSlipsAndWhereNothingYields) {
  const std::shared_ptr<const Specimen> ice = make_specimen(ElasticBody{.friction = 0});
  const Ended slips = run(ice, 3, adaptive(200));
  EXPECT_LE(slips.progress.samples, 200);
  EXPECT_NE(slips.progress.stop, AdaptiveStop::none);
  const std::shared_ptr<const Specimen> rock = make_specimen(ElasticBody{.young_modulus = 1e6});
  const Ended rigid = run(rock, 3, adaptive(120));
  EXPECT_EQ(rigid.progress.samples, 120);
}

TEST(AdaptiveTrials, ChoosesInTimeAlsoAfterManySamples) {
  const std::shared_ptr<const Specimen> body = make_specimen(ElasticBody{});
  const CampaignOptions options = adaptive(170);
  Campaign campaign(plan_of(*body, 3), options);
  const auto arm = make_quasi_static_arm(body);
  double longest = 0;
  while (const auto order = campaign.next()) {
    const TrialRecord record{*order, run_trial(*arm, *order, options.program)};
    const std::clock_t begin = std::clock();
    (void)campaign.take(record);
    longest = std::max(longest, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  EXPECT_LT(longest, 1);
}

TEST(AdaptiveTrials, GivesUpAContactWhereTheArmFindsNothing) {
  class Nothing : public Prober {
    ProbeReport perform(const ProbeAction& action) override {
      const bool touches = action.kind == ProbeActionKind::touch;
      return {touches ? ProbeOutcome::no_contact : ProbeOutcome::done, action.target, 1};
    }
  } nothing;
  const std::shared_ptr<const Specimen> body = make_specimen(ElasticBody{});
  const CampaignOptions options = adaptive(100);
  Campaign campaign(plan_of(*body, 3), options);
  const auto records = perform(campaign, nothing, options, 100);
  EXPECT_EQ(records.size(), static_cast<std::size_t>(3 * options.most_failures));
  EXPECT_EQ(campaign.progress().contacts_given_up, 3);
}

TEST(AdaptiveTrials, RefusesOptionsOutOfRange) {
  const ContactPlan plan = plan_of(*make_specimen(ElasticBody{}), 2);
  EXPECT_THROW(AdaptiveTrials(plan, {}), InvalidInput);
  EXPECT_THROW(AdaptiveTrials(plan, {.until = -1}), InvalidInput);
  EXPECT_THROW(AdaptiveTrials(plan, {.until = std::nan("")}), InvalidInput);
  EXPECT_THROW(AdaptiveTrials({}, {.until = 1}), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
