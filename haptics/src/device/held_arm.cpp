// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/held_arm.h"

#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

probing::VirtualArmOptions held_options(const TimedPath& wish, probing::VirtualArmOptions options) {
  const Eigen::Vector3d begin = wish.position(0);
  const auto joints = probing::joints_at(options.geometry, begin);
  if (!joints) {
    throw InvalidInput("HeldArm: the arm does not reach the beginning of the path, (" +
                       std::to_string(begin.x()) + ", " + std::to_string(begin.y()) + ", " +
                       std::to_string(begin.z()) + ") mm in the frame of its base");
  }
  options.joints = *joints;
  options.gravity.setZero();
  return options;
}

}  // namespace

struct HeldArm::Held {
  Held(TimedPath path, const HandOptions& hand, const probing::VirtualArmOptions& options)
      : wish(std::move(path)),
        grip{.mass = hand.mass,
             .damping = hand.damping,
             .stiffness = hand.stiffness,
             .push = hand.push},
        arm(nullptr, options),
        description(arm.description()) {
    description.name = "held arm";
    description.damping = hand.damping;
    description.delay = description.period;  // a read simulates a whole period
  }

  TimedPath wish;
  probing::HandGrip grip;
  probing::VirtualArm arm;
  devices::DeviceDescription description;
};

HeldArm::HeldArm(TimedPath wish, const HandOptions& hand, probing::VirtualArmOptions arm) {
  static_cast<void>(in_range(hand));
  if (hand.friction != 0) {
    throw InvalidInput("HeldArm: HandOptions::friction must be 0: the arm has friction of its own");
  }
  if (hand.real_time) {
    throw InvalidInput(
        "HeldArm: HandOptions::real_time is set; the simulated arm is on its own "
        "clock");
  }
  const probing::VirtualArmOptions options = held_options(wish, std::move(arm));
  held_ = std::make_unique<Held>(std::move(wish), hand, options);
}

HeldArm::~HeldArm() = default;

const devices::DeviceDescription& HeldArm::description() const noexcept {
  return held_->description;
}

double HeldArm::now() const noexcept { return held_->arm.now(); }

void HeldArm::activate() { held_->arm.activate(); }

bool HeldArm::read(devices::DeviceState& state) noexcept {
  held_->grip.place = held_->wish.position(held_->arm.now());
  held_->arm.hold(held_->grip);
  return held_->arm.read(state);
}

bool HeldArm::write(const devices::DeviceCommand& command) noexcept {
  return held_->arm.write(command);
}

void HeldArm::stop() noexcept { held_->arm.stop(); }

std::string HeldArm::last_error() const { return held_->arm.last_error(); }

}  // namespace palpate::haptics
