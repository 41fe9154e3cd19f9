// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/playback.h"

namespace palpate::haptics {

/// The objects that the tool of a `DeviceLoop` touches, and their state. Each tick is one call of
/// `begin`, any number of `try_tool`, and one of `end`. Real-time safe.
class ToolWorld {
 public:
  virtual ~ToolWorld() = default;
  /// \param now [s] on the device's clock.
  virtual void begin(double now) noexcept = 0;
  /// Returns the command for a tool at this place. Each try starts from the state of the last tick.
  /// \param tool [mm] in the world. \return force and contact in the world.
  [[nodiscard]] virtual Command try_tool(const Eigen::Vector3d& tool) noexcept = 0;
  /// The tick was as in the last try. Without one, the tool is unknown in this tick.
  virtual void end() noexcept = 0;
};

/// One model, which stands still. A tick without a try does not count.
class ModelWorld final : public ToolWorld {
 public:
  /// \param tick [s] > 0, as `Playback::step` takes it.
  explicit ModelWorld(double tick) : tick_(tick) {}

  /// From now on, with a new state. \param playback must outlive its ticks.
  void exchange(const Playback& playback) noexcept {
    playback_ = &playback;
    state_ = {};
  }
  [[nodiscard]] const Playback* playback() const noexcept { return playback_; }

  void begin(double /*now*/) noexcept override { tried_ = false; }
  [[nodiscard]] Command try_tool(const Eigen::Vector3d& tool) noexcept override {
    trial_ = state_;
    tried_ = true;
    return playback_->step(tool, trial_, tick_);
  }
  void end() noexcept override {
    if (tried_) state_ = trial_;
  }

 private:
  double tick_;
  const Playback* playback_ = nullptr;
  LoopState state_, trial_;
  bool tried_ = false;
};

}  // namespace palpate::haptics
