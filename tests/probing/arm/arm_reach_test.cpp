// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_reach.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "not_finite.h"
#include "palpate/error.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/closed_form.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

ReachOptions options_over(const Specimen& specimen) {
  ReachOptions options;
  options.T_world_base = mount_over(specimen.surface(), options.geometry);
  return options;
}

TEST(ArmReach, AgreesWithForwardKinematicsOfJointsInsideAndOutsideTheirRange) {
  ReachOptions options;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(-2, 2), upper(-1.2, 1.9), bend(-1.3, 1.3);
  int inside = 0, outside = 0;
  for (int i = 0; i < 10000; ++i) {
    Vector3d joints(turn(random), upper(random), 0);
    joints[2] = joints[1] + bend(random);
    const Vector3d tip = tip_position(options.geometry, joints);
    const double radius =
        options.geometry.upper * std::cos(joints[1]) + options.geometry.lower * std::sin(joints[2]);
    if (radius < 2 * options.margin) continue;  // the inverse takes another branch there
    const double sum = options.geometry.upper + options.geometry.lower;
    const double difference = options.geometry.upper - options.geometry.lower;
    const bool in_range = (joints.array() >= options.lowest_joints.array()).all() &&
                          (joints.array() <= options.highest_joints.array()).all();
    const Reach expected = tip.norm() > sum - options.margin          ? Reach::too_far
                           : tip.norm() < difference + options.margin ? Reach::too_near
                           : in_range                                 ? Reach::reachable
                                                                      : Reach::joint_limit;
    EXPECT_EQ(reach_of(tip, options), expected) << joints.transpose();
    (expected == Reach::reachable ? inside : outside) += 1;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

TEST(ArmReach, AnArmMountedOverASheetReachesItsWholePlan) {
  const std::shared_ptr<const Specimen> sheet = make_specimen(Sheet{});
  const ContactPlan plan = plan_contacts(sheet->surface());
  const PlanReach reach = reach_of_plan(plan, options_over(*sheet));
  EXPECT_EQ(reach.counts[0], static_cast<int>(plan.contacts.size()));
}

TEST(ArmReach, NamesContactsThatAreTooFarAndForcesThatAreTooLarge) {
  const std::shared_ptr<const Specimen> sheet = make_specimen(Sheet{});
  ContactPlan plan = plan_contacts(sheet->surface(), {.contacts = 3});
  plan.contacts[1].position.y() += 500;
  plan.contacts[2].position.x() = kNaN;
  const ReachOptions options = options_over(*sheet);
  const PlanReach reach = reach_of_plan(plan, options);
  EXPECT_EQ(reach.contacts[0], Reach::reachable);
  EXPECT_EQ(reach.contacts[1], Reach::too_far);
  EXPECT_EQ(reach.contacts[2], Reach::too_far);
  EXPECT_EQ(reach.counts[static_cast<std::size_t>(Reach::too_far)], 2);

  // A vertical force has the lever r = l1 c1 + ... of joint 1: nowhere longer than l1.
  const double lever = options.geometry.upper;
  ContactPlan strong = plan_contacts(sheet->surface(), {.contacts = 1, .directions = 0});
  const auto with_force = [&](double force) {
    strong.normal_forces = {force};
    return reach_of_plan(strong, options).contacts[0];
  };
  EXPECT_EQ(with_force(0.5 * options.highest_torque / lever), Reach::reachable);
  EXPECT_EQ(with_force(1.5 * options.highest_torque / lever), Reach::too_weak);
}

TEST(ArmReach, RefusesOptionsOutOfRange) {
  ReachOptions options;
  options.share = 1.5;
  EXPECT_THROW(static_cast<void>(reach_of_plan({}, options)), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
