// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "palpate/devices/device.h"
#include "palpate/devices/safety_filter.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/passivity_observer.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/tool_world.h"
#include "palpate/haptics/virtual_coupling.h"

namespace palpate::haptics {

struct DeviceLoopOptions {
  /// Pose of the device's workspace in the object's frame.
  Eigen::Isometry3d T_world_device = Eigen::Isometry3d::Identity();
  /// [mm/mm] of the object for one of the device; > 0. Default: as the device declares. The force
  /// is not scaled, so that the device feels the object's stiffness times the scale.
  std::optional<double> scale = {};
  /// Bits of the buttons that clutch, besides those that the device declares.
  std::uint32_t clutch_buttons = 0;
  devices::SafetyOptions safety = {};
  CouplingOptions coupling = {};
};

/// The input of the loop from a device in one tick.
struct TickInput {
  double now = 0;          ///< [s] on the device's clock, after the read
  bool answered = true;    ///< the device gave a state
  bool exchanged = false;  ///< the model is another one than in the tick before
  devices::DeviceState state = {};
};

/// The output of the loop in one tick.
struct TickOutput {
  devices::SafeCommand command;                       ///< for the device, in the frame of its base
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();     ///< [mm] world, on the coupling's far side
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();  ///< [mm] as in `Command`
  ContactState state = ContactState::free;
};

/// The loop between a device and a model or a scene, one tick after the other: the device's frame,
/// scale and clutch, the virtual coupling, `Playback`, and the safety filter. Equal inputs give
/// equal outputs, bit by bit. Real-time safe. One thread; several loops may share a `Playback`.
class DeviceLoop {
 public:
  /// \throws InvalidInput on an option outside its range.
  explicit DeviceLoop(const devices::DeviceDescription& device,
                      const DeviceLoopOptions& options = {});

  [[nodiscard]] TickOutput tick(const Playback& playback, const TickInput& input) noexcept;
  /// The same with a world, which must be the same in all ticks.
  [[nodiscard]] TickOutput tick(ToolWorld& world, const TickInput& input) noexcept;
  /// Before the command is written: zero if it took too long. \param age [s] since `TickInput::now`
  void check_age(double age, TickOutput& output) noexcept;

  [[nodiscard]] const GivenEnergy& given() const noexcept { return observer_.given(); }
  /// [N/mm] of the coupling's spring, at the device; infinite without coupling.
  [[nodiscard]] double coupling_stiffness() const noexcept;
  /// [mm/mm] of the object for one of the device.
  [[nodiscard]] double scale() const noexcept { return scale_; }

 private:
  [[nodiscard]] Eigen::Vector3d touch(ToolWorld& world, const Eigen::Vector3d& device,
                                      TickOutput& output) noexcept;
  void enter(const Playback& playback) noexcept;

  DeviceLoopOptions options_;
  Eigen::Matrix3d rotation_;  // of T_world_device
  double scale_;
  std::uint32_t clutch_buttons_;
  double spring_;  // [N/mm] in the world
  devices::SafetyFilter safety_;
  PassivityObserver observer_;
  CouplingState coupling_;
  ModelWorld model_;
  Command trial_;  // of the tool that was tried last
  bool clutched_ = false, has_place_ = false;
  Eigen::Vector3d clutch_offset_ = Eigen::Vector3d::Zero();  // [mm] world
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();  // [mm] world, of the device in the last tick
  TickOutput last_;
};

}  // namespace palpate::haptics
