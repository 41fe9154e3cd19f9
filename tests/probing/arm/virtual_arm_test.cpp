// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/virtual_arm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "block_specimen.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/closed_form.h"
#include "refusal.h"

namespace palpate::probing {
namespace {

/// An arm without friction, noise, flexure of the encoders and viscosity.
VirtualArmOptions ideal_arm() {
  VirtualArmOptions options;
  options.friction.setZero();
  options.viscosity = 0;
  options.encoder_step = 1e-12;
  options.torque_noise = options.torque_gain_error = options.force_noise = 0;
  return options;
}

devices::DeviceState next_state(VirtualArm& arm, const Eigen::Vector3d& force) {
  EXPECT_TRUE(arm.write({.force = force}));
  devices::DeviceState state;
  EXPECT_TRUE(arm.read(state));
  return state;
}

/// [N mm] Energy of the two masses and three rotors, independent of the equations of motion.
double energy(const VirtualArmOptions& o, const Eigen::Vector3d& q, const Eigen::Vector3d& v) {
  const auto masses = [&](const Eigen::Vector3d& joints) {
    const auto place = [&](double r, double y) {
      return Eigen::Vector3d(r * std::sin(joints[0]), y, r * std::cos(joints[0]));
    };
    const double a1 = o.geometry.upper / 2, a2 = o.geometry.lower / 2;
    const double u = joints[1] + o.upper_angle, w = joints[2] + o.lower_angle;
    return std::array{place(a1 * std::cos(u), a1 * std::sin(u)),
                      place(o.geometry.upper * std::cos(joints[1]) + a2 * std::sin(w),
                            o.geometry.upper * std::sin(joints[1]) - a2 * std::cos(w))};
  };
  constexpr double kStep = 1e-5;
  const auto before = masses(q - kStep * v), now = masses(q), after = masses(q + kStep * v);
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += o.rotor[i] * v[i] * v[i] / 2;
  const std::array mass{o.upper_mass, o.lower_mass};
  for (std::size_t i = 0; i < 2; ++i) {
    sum += mass[i] *
           (((after[i] - before[i]) / (2 * kStep)).squaredNorm() / 2 - o.gravity.dot(now[i]));
  }
  return sum * 1e-3;
}

TEST(VirtualArm, KeepsItsEnergyInFreeMotion) {
  VirtualArmOptions options = ideal_arm();
  options.gravity = {800, -9600, 1500};  // on a tilted base
  options.joints = {0.2, 0.5, 0.1};
  VirtualArm arm(nullptr, options);
  std::vector<Eigen::Vector3d> joints;
  devices::DeviceState state;
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(arm.read(state));
    joints.push_back(state.joints);
  }
  const auto at = [&](std::size_t i) {
    return energy(options, joints[i], (joints[i + 1] - joints[i - 1]) / 2e-3);
  };
  double lowest = kInf, highest = -kInf;
  for (const auto& q : joints) {
    const double potential = energy(options, q, Eigen::Vector3d::Zero());
    lowest = std::min(lowest, potential);
    highest = std::max(highest, potential);
  }
  EXPECT_GT(highest - lowest, 60);  // it fell and swung
  for (std::size_t i = 1; i + 1 < joints.size(); ++i) {
    EXPECT_NEAR(at(i), at(1), 0.01 * (highest - lowest)) << i;
  }
}

TEST(VirtualArm, RestsOnTheSpecimenWhereItsTruthSays) {
  const support::BlockSpecimen block(0.8);
  VirtualArmOptions options = support::arm_above_block(2);
  options.gravity.setZero();
  options.friction.setZero();
  options.viscosity = 200;  // comes to rest soon
  options.torque_noise = options.torque_gain_error = options.force_noise = 0;
  VirtualArm arm(&block, options);
  arm.activate();
  for (const double pressing : {0.3, 1.2, 0.5}) {
    const Eigen::Vector3d force(0.2, -pressing, -0.1);
    devices::DeviceState state;
    for (int i = 0; i < 1500; ++i) state = next_state(arm, force);
    const VirtualArmTruth& truth = arm.truth();
    ASSERT_TRUE(truth.in_contact);
    EXPECT_LT((truth.force - force).norm(), 2e-3);
    const Eigen::Vector3d f_world = options.T_world_base.linear() * truth.force;
    const Eigen::Vector3d p_world_tip = options.T_world_base * truth.tip;
    EXPECT_LT((p_world_tip - truth.contact - block.displacement(truth.contact, f_world)).norm(),
              2e-3);
    // The encoders see the flexure of the arm besides.
    EXPECT_LT((state.tip - truth.tip - truth.force / options.structure).norm(), 0.05);
  }
}

TEST(VirtualArm, SlipsBeyondTheFrictionConeOnly) {
  for (const double pull : {0.40, 0.60}) {  // times the normal force; the coefficient is 0.5
    const support::BlockSpecimen block(0.8, 0.5);
    VirtualArmOptions options = support::arm_above_block(2);
    options.gravity.setZero();
    options.friction.setZero();
    options.viscosity = 200;
    VirtualArm arm(&block, options);
    arm.activate();
    for (int i = 0; i < 1500; ++i) next_state(arm, {0, -1, 0});
    ASSERT_TRUE(arm.truth().in_contact);
    EXPECT_LT(arm.truth().slid, 0.05);
    for (int i = 0; i < 500; ++i) {
      next_state(arm, {pull * std::min(1.0, i / 300.0), -1, 0});
      if (!arm.truth().in_contact) break;
      const Eigen::Vector3d f = options.T_world_base.linear() * arm.truth().force;
      EXPECT_LT(f.head<2>().norm(), 0.56 * -f.z());
    }
    if (pull < 0.5) {
      EXPECT_LT(arm.truth().slid, 0.05);
    } else {
      EXPECT_GT(arm.truth().slid, 1);
    }
  }
}

// Beside a support, where the object stiffens quickly, updates of its compliance along a few
// directions can make it negative in others; the force then grows to several times the commanded.
TEST(VirtualArm, KeepsTheForceBoundedWhenTheTipSlidesTowardsASupport) {
  struct Slide {
    double x, y;             // [mm] where the tip is pressed
    double pressing, angle;  // [N]; [rad] of the pull from the way to the support
  };
  const Sheet sheet;
  const std::shared_ptr<const Specimen> specimen = make_specimen(sheet);
  for (const Slide& slide : {Slide{36, -30, 1, 0}, Slide{36, 60, 1.8, 0.5}, Slide{44, 0, 1, 0.5}}) {
    VirtualArmOptions options;
    options.T_world_base = mount_over(specimen->surface(), options.geometry);
    options.gravity.setZero();
    options.viscosity = 20;
    const Eigen::Isometry3d T_base_world = options.T_world_base.inverse();
    const Eigen::Vector3d above = surface_at(sheet, slide.x, slide.y) - Eigen::Vector3d::UnitZ();
    options.joints = joints_at(options.geometry, T_base_world * above).value();
    VirtualArm arm(specimen.get(), options);
    arm.activate();
    const Eigen::Vector3d press = slide.pressing * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d pull =
        1.3 * slide.pressing * Eigen::Vector3d(std::cos(slide.angle), std::sin(slide.angle), 0);
    double highest = 0, nearest = kInf;
    for (int i = 0; i < 2500; ++i) {
      const double share = std::clamp((i - 800) / 600.0, 0.0, 1.0);
      next_state(arm, T_base_world.linear() * (press + share * pull));
      if (arm.truth().in_contact)
        nearest = std::min(nearest, sheet.support - arm.truth().contact.x());
      highest = std::max(highest, arm.truth().force.norm());
    }
    EXPECT_LT(nearest, 8) << slide.x;  // [mm] from the support: it slid there
    EXPECT_LT(highest, 2 * (press + pull).norm()) << slide.x << ", " << slide.y;
  }
}

TEST(VirtualArm, StandsStillUntilFrictionIsOvercome) {
  VirtualArmOptions options;
  options.gravity.setZero();
  options.friction_variation = options.torque_gain_error = 0;
  const double friction = options.friction[1] / options.geometry.upper;  // [N] at the tip, vertical
  EXPECT_NEAR(friction, 0.048, 0.001);
  for (const double factor : {0.8, 1.1}) {
    VirtualArm arm(nullptr, options);
    arm.activate();
    const double begin = arm.truth().tip.y();
    for (int i = 0; i < 500; ++i) next_state(arm, {0, factor * friction, 0});
    const double way = arm.truth().tip.y() - begin;
    if (factor < 1) {
      EXPECT_LT(way, 0.5);
    } else {
      EXPECT_GT(way, 3);
    }
  }
}

TEST(VirtualArm, RestsAfterSecondsAtItsHighestForceAndNeverBelowItsContinuousForce) {
  VirtualArmOptions options;
  options.gravity.setZero();
  const support::BlockSpecimen block(5);
  VirtualArmOptions on_block = support::arm_above_block(0.5);
  on_block.gravity.setZero();
  const double continuous = on_block.continuous_torque / on_block.geometry.upper;
  for (const double force : {3.0, 0.95 * continuous}) {
    VirtualArm arm(&block, on_block);
    arm.activate();
    double tripped = 0;
    for (int i = 0; i < 12000 && tripped == 0; ++i) {
      const devices::DeviceState state = next_state(arm, {0, -force, 0});
      if (i > 100 && state.delivered_force.norm() < force / 2) tripped = state.time;
    }
    // du/dt = ((F / F_continuous)^2 - u) / T reaches 1
    const double load = force * force / (continuous * continuous);
    if (load > 1) {
      EXPECT_NEAR(tripped, -on_block.heating_time * std::log(1 - 1 / load), 0.2);
    } else {
      EXPECT_EQ(tripped, 0);
    }
  }
}

TEST(VirtualArm, DropsTheForceWhenTheLeaseEnds) {
  VirtualArm arm(nullptr, VirtualArmOptions{});
  arm.activate();
  ASSERT_TRUE(arm.write({.force = {0, 1, 0}, .lease = 0.005}));
  devices::DeviceState state;
  for (int i = 1; i <= 10; ++i) {
    ASSERT_TRUE(arm.read(state));
    EXPECT_NEAR(state.delivered_force.norm(), i <= 5 ? 1 : 0, 0.05) << i;
  }
}

TEST(VirtualArm, RepeatsItselfBitByBitAndItsNoiseFollowsTheSample) {
  const auto run = [](std::uint64_t seed, std::uint64_t sample) {
    VirtualArmOptions options;
    options.seed = seed;
    options.torque_gain_error = 0;
    VirtualArm arm(nullptr, options);
    arm.activate();
    arm.begin_sample(sample);
    devices::DeviceState state;
    for (int i = 0; i < 50; ++i) state = next_state(arm, {0.1, 0.6, 0});
    return state.delivered_force;
  };
  EXPECT_EQ(run(1, 1), run(1, 1));
  EXPECT_NE(run(1, 1), run(2, 1));
  EXPECT_NE(run(1, 1), run(1, 2));
}

TEST(VirtualArm, GoesOnFromItsMemoryBitByBit) {
  VirtualArmOptions options;
  VirtualArm whole(nullptr, options);
  whole.activate();
  for (int i = 0; i < 200; ++i) next_state(whole, {0.1, 0.5 + 0.2 * std::sin(0.05 * i), -0.1});
  options.joints = {0.3, 0.2, 0.1};  // anywhere else
  VirtualArm resumed(nullptr, options);
  resumed.restore(whole.memory());
  EXPECT_EQ(resumed.now(), whole.now());
  for (VirtualArm* arm : {&whole, &resumed}) arm->activate();
  for (int i = 0; i < 100; ++i) {
    const devices::DeviceState expected = next_state(whole, {0, 0.6, 0}),
                               found = next_state(resumed, {0, 0.6, 0});
    ASSERT_EQ(found.joints, expected.joints) << i;
    ASSERT_EQ(found.delivered_force, expected.delivered_force) << i;
    ASSERT_EQ(found.heat, expected.heat) << i;
    ASSERT_EQ(found.time, expected.time) << i;
  }
}

TEST(VirtualArm, RunsFiftyTimesAsFastAsRealTime) {
  const support::BlockSpecimen block(0.8);
  VirtualArm arm(&block, support::arm_above_block(2));
  arm.activate();
  // The quickest of a few runs: others share the machine.
  double quickest = kInf;
  for (int run = 0; run < 5; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 500; ++i) next_state(arm, {0, -0.4 - 0.2 * (i % 2), 0});
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    quickest = std::min(quickest, took.count());
  }
  EXPECT_TRUE(arm.truth().in_contact);
  RecordProperty("us_per_tick", std::to_string(quickest / 500 * 1e6));
#ifdef NDEBUG
  EXPECT_LT(quickest / 500, 20e-6);
#endif
}

TEST(VirtualArm, SaysWhyTheObjectDoesNotAnswer) {
  class BreakingBlock final : public Specimen {
   public:
    const geometry::TriangleMesh& surface() const override { return block_.surface(); }
    Eigen::Vector3d displacement(const Eigen::Vector3d&, const Eigen::Vector3d&) const override {
      throw SolverError("elements turned inside out");
    }
    FrictionCone friction_cone(const Eigen::Vector3d& contact) const override {
      return block_.friction_cone(contact);
    }

   private:
    support::BlockSpecimen block_{0.8};
  } const broken;
  VirtualArmOptions options;
  options.T_world_base = mount_over(broken.surface(), options.geometry);
  VirtualArm arm(&broken, options);
  EXPECT_EQ(arm.last_error(), "");
  arm.activate();
  devices::DeviceState state;
  bool answers = true;
  for (int i = 0; i < 5000 && answers; ++i) {
    answers = arm.read(state);
    (void)arm.write({.force = Eigen::Vector3d(0, -1, 0)});  // down, onto the block
  }
  EXPECT_FALSE(answers);
  EXPECT_EQ(arm.last_error(), "elements turned inside out");
  arm.activate();
  EXPECT_EQ(arm.last_error(), "");
}

TEST(VirtualArm, RefusesWrongOptionsAndCommands) {
  VirtualArmOptions options;
  options.structure = 0;
  EXPECT_EQ(refusal([&] { return VirtualArm(nullptr, options); }),
            "VirtualArmOptions::structure is 0 N/mm; it must be > 0 and finite");
  VirtualArm arm(nullptr);
  EXPECT_FALSE(arm.write({}));  // not active
  arm.activate();
  EXPECT_FALSE(arm.write({.force = {0, kNaN, 0}}));
  EXPECT_TRUE(arm.write({}));
}

}  // namespace
}  // namespace palpate::probing
