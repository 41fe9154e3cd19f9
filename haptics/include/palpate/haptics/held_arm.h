// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "palpate/haptics/simulated_hand.h"
#include "palpate/probing/virtual_arm.h"

namespace palpate::haptics {

/// The simulated arm of probing as a haptic device: with joints, friction, encoders and motors that
/// heat, its tip held by a hand. The arm's gravity is taken as compensated by its driver.
class HeldArm final : public devices::Device {
 public:
  /// \param wish where the hand wants the tip, in the frame of the arm's base.
  /// \param hand its mass, damping, stiffness and push; the rest is the arm's own. The simulation is
  /// on its own clock.
  /// \throws InvalidInput on an option outside its range, `real_time`, or a beginning of the path
  /// that the arm does not reach.
  explicit HeldArm(TimedPath wish, const HandOptions& hand = {},
                   probing::VirtualArmOptions arm = {});
  ~HeldArm() override;

  [[nodiscard]] const devices::DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  [[nodiscard]] bool read(devices::DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const devices::DeviceCommand& command) noexcept override;
  void stop() noexcept override;
  [[nodiscard]] std::string last_error() const override;

 private:
  struct Held;
  std::unique_ptr<Held> held_;
};

}  // namespace palpate::haptics
