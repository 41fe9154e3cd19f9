// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/scene.h"
#include "palpate/haptics/scene_play.h"
#include "palpate/haptics/tool_world.h"

namespace palpate::haptics {

/// A scene in which a device moves one tool. The objects and the other tools follow their paths,
/// from the first time of any of them on; this is the device's time of the first tick. If nothing
/// is known of the device's tool in a tick, it stands still, and objects may run into it.
class SceneWorld final : public ToolWorld {
 public:
  /// Allocates everything that a tick needs.
  /// \param motion of all objects and tools; the path of the device's tool in it is ignored.
  /// \param tool of the device, from 0.
  /// \throws InvalidInput without a scene, one path for each object, or such a tool.
  SceneWorld(std::shared_ptr<const Scene> scene, SceneMotion motion, std::size_t tool);

  void begin(double now) noexcept override;
  [[nodiscard]] Command try_tool(const Eigen::Vector3d& place) noexcept override;
  void end() noexcept override;

  [[nodiscard]] const Scene& scene() const noexcept { return *scene_; }
  [[nodiscard]] std::size_t tool() const noexcept { return tool_; }
  /// Of the last tick: where all were, and what all tools and objects felt.
  [[nodiscard]] const SceneInput& input() const noexcept { return input_; }
  [[nodiscard]] const SceneCommand& command() const noexcept { return state_.command(); }

 private:
  std::shared_ptr<const Scene> scene_;
  SceneMotion motion_;
  std::size_t tool_;
  double begin_;                // [s] the first time of any path
  std::optional<double> zero_;  // [s] the device's time of the first tick
  SceneInput input_;
  bool has_place_ = false, tried_ = false;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();  // [mm] of the device's tool, the last known
  SceneState state_, trial_;
};

/// The trace of a session with a scene, computed again. The force of the device's tool is the one
/// that was commanded, and there is a point of it for each tick.
/// \param world as it was at the start of the session.
[[nodiscard]] SceneTrace trace_of(const LoopRecord& record, SceneWorld& world);

}  // namespace palpate::haptics
