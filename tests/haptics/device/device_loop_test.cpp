// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/device_loop.h"
#include "not_finite.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "palpate/haptics/rotation.h"
#include "refusal.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

/// [N/mm] At any depth that the tests press: at rest 0.4, and less below.
constexpr double kEpsilon = 10;
const Eigen::Vector3d kAboveSheet(3, 4, 695);

Eigen::Vector3d reaction_of_sheet(const Eigen::Vector3d& displacement) {
  return -4 * displacement / std::hypot(displacement.norm(), kEpsilon);
}

devices::DeviceDescription some_device() {
  return {.name = "some", .highest_force = 10, .continuous_force = 10};
}

/// Drives a loop at 1 kHz.
class Driver {
 public:
  explicit Driver(const DeviceLoopOptions& options = {},
                  const devices::DeviceDescription& device = some_device())
      : loop(device, options) {}

  TickOutput tick(const Eigen::Vector3d& tip, devices::DeviceState state = {},
                  bool exchanged = false) {
    now += 1e-3;
    state.tip = tip;
    state.time = now;
    return loop.tick(*playback, {.now = now, .exchanged = exchanged, .state = state});
  }
  /// Straight from one place to another, then as many ticks there.
  TickOutput move(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int rest = 0) {
    TickOutput output;
    constexpr int kSteps = 700;  // longer than the ramp
    for (int i = 0; i < kSteps; ++i) output = tick(from + (i + 1.0) / kSteps * (to - from));
    for (int i = 0; i < rest; ++i) output = tick(to);
    return output;
  }

  const Playback sheet = Playback(sheet_model());
  const Playback* playback = &sheet;
  DeviceLoop loop;
  double now = 0;
};

const DeviceLoopOptions kPlain{.coupling = {.on = false}};

TEST(DeviceLoop, CommandsTheForceOfPlayback) {
  Driver driver(kPlain);
  const TickOutput output = driver.move(kAboveSheet, {3, 4, 705}, 10);
  EXPECT_EQ(output.state, ContactState::stick);
  EXPECT_LT((output.command.force - reaction_of_sheet({0, 0, 5})).norm(), 1e-9);
  EXPECT_LT((output.tool - Eigen::Vector3d(3, 4, 705)).norm(), 1e-12);
  EXPECT_LT((output.contact - Eigen::Vector3d(3, 4, 700)).norm(), 1e-6);
  EXPECT_EQ(driver.loop.coupling_stiffness(), std::numeric_limits<double>::infinity());
}

TEST(DeviceLoop, CouplesByTheDevicesDampingAndDelay) {
  devices::DeviceDescription device = some_device();
  device.damping = 1.5e-3;
  device.delay = 1e-3;
  Driver driver({}, device);
  EXPECT_NEAR(driver.loop.coupling_stiffness(), 0.5, 1e-12);
  const TickOutput output = driver.move(kAboveSheet, {3, 4, 705}, 10);
  // The spring and the sheet balance: 0.5 (5 - d) = 4 d / sqrt(d^2 + 10^2).
  const double depth = output.tool.z() - 700;
  const double felt = output.command.force.norm();
  EXPECT_NEAR(felt, 0.5 * (5 - depth), 1e-9);
  EXPECT_NEAR(felt, reaction_of_sheet({0, 0, depth}).norm(), 1e-3);
  EXPECT_LT(output.command.force.z(), -1);
}

TEST(DeviceLoop, TurnsForcesIntoTheDevicesFrame) {
  DeviceLoopOptions options = kPlain;
  options.T_world_device.linear() = rotation_exp({0.3, -1, 0.7});
  options.T_world_device.translation() << 10, 20, 600;
  const auto to_device = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return options.T_world_device.inverse() * p;
  };
  Driver driver(options);
  const TickOutput output = driver.move(to_device(kAboveSheet), to_device({5, 4, 705}), 10);
  const Eigen::Vector3d in_world = options.T_world_device.linear() * output.command.force;
  EXPECT_LT((in_world - reaction_of_sheet(output.tool - output.contact)).norm(), 1e-6);
  EXPECT_GT(in_world.norm(), 1);
}

TEST(DeviceLoop, ScalesTheWorkspace) {
  DeviceLoopOptions options = kPlain;
  devices::DeviceDescription device = some_device();
  device.workspace_scale = 5;
  Driver declared(options, device);
  EXPECT_EQ(declared.loop.scale(), 5);
  TickOutput output = declared.move(kAboveSheet / 5, Eigen::Vector3d(3, 4, 705) / 5, 10);
  EXPECT_LT((output.command.force - reaction_of_sheet({0, 0, 5})).norm(), 1e-9);
  options.scale = 10;
  Driver chosen(options, device);
  output = chosen.move(kAboveSheet / 10, Eigen::Vector3d(3, 4, 705) / 10, 10);
  EXPECT_LT((output.command.force - reaction_of_sheet({0, 0, 5})).norm(), 1e-9);
}

TEST(DeviceLoop, HoldsNoMoreThanTheContinuousForceThatTheDeviceDeclares) {
  devices::DeviceDescription device = some_device();
  device.continuous_force = 1;
  DeviceLoopOptions options = kPlain;
  options.safety.heating_time = 2;
  Driver driver(options, device);
  const Eigen::Vector3d inside(3, 4, 705);
  EXPECT_GT(driver.move(kAboveSheet, inside, 10).command.force.norm(), 1.7);
  TickOutput output;
  for (int i = 0; i < 3000; ++i) output = driver.tick(inside);
  EXPECT_NEAR(output.command.force.norm(), 1, 1e-3);
  EXPECT_NE(output.command.actions & static_cast<std::uint32_t>(devices::SafetyAction::heated), 0U);
}

TEST(DeviceLoop, KeepsTheToolWhileTheClutchIsPressed) {
  devices::DeviceDescription device = some_device();
  device.clutch_buttons = 4;
  Driver driver(kPlain, device);
  const Eigen::Vector3d inside(3, 4, 705), away(60, 70, 650);
  EXPECT_GT(driver.move(kAboveSheet, inside, 10).command.force.norm(), 1);
  TickOutput output;
  for (int i = 1; i <= 100; ++i) {
    const Eigen::Vector3d tip = inside + i / 100.0 * (away - inside);
    output = driver.tick(tip, {.buttons = 4 | 1});
    EXPECT_EQ(output.command.force, Eigen::Vector3d::Zero());
    EXPECT_LT((output.tool - inside).norm(), 1e-9);
  }
  // Released: the same contact, its force from zero with the ramp.
  output = driver.tick(away);
  EXPECT_LT((output.tool - inside).norm(), 1e-9);
  EXPECT_EQ(output.state, ContactState::stick);
  EXPECT_LT(output.command.force.norm(), 0.01);
  for (int i = 0; i < 600; ++i) output = driver.tick(away);
  EXPECT_LT((output.command.force - reaction_of_sheet({0, 0, 5})).norm(), 1e-6);
  // A device may have a clutch of its own, and its user other buttons.
  EXPECT_EQ(driver.tick(away, {.clutched = true}).command.force, Eigen::Vector3d::Zero());
}

TEST(DeviceLoop, KeepsTheContactThroughStatesThatAreNotFinite) {
  Driver driver(kPlain);
  const Eigen::Vector3d inside(3, 4, 705);
  driver.move(kAboveSheet, inside, 10);
  TickOutput output;
  for (int i = 0; i < 5; ++i) {
    output = driver.tick({kNaN, 4, 705});
    EXPECT_EQ(output.command.force, Eigen::Vector3d::Zero());
  }
  output = driver.tick(inside);
  EXPECT_EQ(output.state, ContactState::stick);
  EXPECT_LT(output.command.force.norm(), 0.01);
  for (int i = 0; i < 600; ++i) output = driver.tick(inside);
  EXPECT_LT((output.command.force - reaction_of_sheet({0, 0, 5})).norm(), 1e-6);
}

TEST(DeviceLoop, RampsTheForceAfterAJumpOfThePosition) {
  const Eigen::Vector3d inside(3, 4, 705), far(3, 4, 760);
  for (const int ticks : {1, 5, 30}) {  // while playback keeps the contact, and after
    Driver driver(kPlain);
    EXPECT_GT(driver.move(kAboveSheet, inside, 10).command.force.norm(), 1);
    TickOutput output;
    for (int i = 0; i < ticks; ++i) {
      output = driver.tick(far);
      EXPECT_EQ(output.command.force, Eigen::Vector3d::Zero()) << i;
    }
    for (int i = 0; i < 30; ++i) {
      output = driver.tick(inside);
      EXPECT_LT(output.command.force.norm(), 0.11) << i;  // of 1.8 N, after 0.03 of 0.5 s
    }
  }
}

TEST(DeviceLoop, NeverCommandsMoreThanTheDeviceCan) {
  devices::DeviceDescription device = some_device();
  device.highest_force = 0.7;
  Driver driver(kPlain, device);
  const TickOutput output = driver.move(kAboveSheet, {3, 4, 705}, 10);
  EXPECT_NEAR(output.command.force.norm(), 0.7, 1e-9);
}

TEST(DeviceLoop, RampsTheForceOfAToolThatIsInsideFromTheFirstTick) {
  for (const bool coupled : {false, true}) {
    DeviceLoopOptions options;
    options.coupling.on = coupled;
    Driver driver(options);
    double last = 0;
    for (int i = 0; i < 600; ++i) {
      const double felt = driver.tick({3, 4, 706}).command.force.norm();
      // 2 N over a ramp of 0.5 s, and a little more while playback finds them.
      EXPECT_LT(felt - last, 0.02) << i;
      last = felt;
    }
  }
}

TEST(DeviceLoop, GoesOverToAnotherModelWithoutAStep) {
  for (const bool coupled : {false, true}) {
    DeviceLoopOptions options;
    options.coupling.on = coupled;
    Driver driver(options);
    const Eigen::Vector3d inside(3, 4, 704);
    const double before = driver.move(kAboveSheet, inside, 600).command.force.norm();
    Model stiffer = sheet_model();
    for (ContactModel& contact : stiffer.contacts) contact.field = spring(7, kEpsilon);
    const Playback other(stiffer);
    driver.playback = &other;
    double last = driver.tick(inside, {}, true).command.force.norm();
    EXPECT_NEAR(last, before, 1e-9);
    for (int i = 0; i < 100; ++i) {
      const double felt = driver.tick(inside).command.force.norm();
      EXPECT_GE(felt, last - 1e-3) << i;  // the tolerance of the coupling
      EXPECT_LT(felt - last, 0.1);
      last = felt;
    }
    EXPECT_GT(last, before + (coupled ? 0.001 : 0.9));
    if (!coupled) {
      EXPECT_NEAR(last, 7.0 / 4 * before, 1e-6);
    }
  }
}

TEST(DeviceLoop, GivesAHandNoMoreEnergyThanSamplingDoes) {
  DeviceLoopOptions options = kPlain;
  Driver driver(options);
  driver.move(kAboveSheet, kAboveSheet);  // a ramp while it presses would count as a gift
  driver.move(kAboveSheet, {3, 4, 705});
  driver.move({3, 4, 705}, kAboveSheet);
  const GivenEnergy& given = driver.loop.given();
  EXPECT_EQ(given.touches, 1);
  // K v^2 T t of a held spring: 0.4 N/mm, 0.0143 mm a tick, 700 ticks.
  EXPECT_LT(given.in_touches, 0.4 * 0.0143 * 0.0143 * 700);
}

// A hand that goes back without a force is given nothing.
TEST(DeviceLoop, CountsNoEnergyOfAForceThatWasTakenBack) {
  for (const bool answered : {false, true}) {
    Driver driver(kPlain);
    driver.move(kAboveSheet, kAboveSheet);
    TickOutput output = driver.move(kAboveSheet, {3, 4, 705});
    EXPECT_GT(output.command.force.norm(), 1);
    if (answered) {  // but it computed for too long
      output = driver.tick({3, 4, 705});
      driver.loop.check_age(0.02, output);
    } else {
      driver.now += 1e-3;
      output = driver.loop.tick(driver.sheet, {.now = driver.now, .answered = false});
    }
    EXPECT_EQ(output.command.force, Eigen::Vector3d::Zero());
    driver.tick(kAboveSheet);
    driver.tick(kAboveSheet);
    EXPECT_EQ(driver.loop.given().touches, 1) << answered;
    EXPECT_EQ(driver.loop.given().in_touches, 0) << answered;
  }
}

TEST(DeviceLoop, RefusesWhatCannotBe) {
  const auto message = [](const DeviceLoopOptions& options) {
    return refusal([&] { return DeviceLoop(some_device(), options).scale(); });
  };
  EXPECT_NE(message({.scale = 0}).find("DeviceLoopOptions::scale"), std::string::npos);
  DeviceLoopOptions sheared;
  sheared.T_world_device.linear()(0, 1) = 0.1;
  EXPECT_NE(message(sheared).find("is no rigid motion"), std::string::npos);
  EXPECT_NE(message({.safety = {.ramp = 0}}).find("SafetyOptions::ramp"), std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
