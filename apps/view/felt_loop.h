// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "latest_value.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/device_loop.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/tool_world.h"
#include "palpate/haptics/trajectory_device.h"
#include "tool_motion.h"

namespace palpate::view {

/// The result of one tick of the loop, for the window.
struct FeltTick {
  double time = 0;                                      ///< [s] on the device's clock
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();       ///< [mm]
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();    ///< [mm] on the undeformed surface
  Eigen::Vector3d force = Eigen::Vector3d::Zero();      ///< [N] of the model on the user
  Eigen::Vector3d commanded = Eigen::Vector3d::Zero();  ///< [N] that the safety layer let through
  haptics::ContactState state = haptics::ContactState::free;
};

/// Ticks from the loop to the window: neither waits. If the window is half a minute behind, ticks
/// are lost to it.
class TickFeed {
 public:
  /// The thread of the loop.
  void put(const FeltTick& tick) noexcept;
  /// The thread of the window. The next tick, in their order; none if all were taken.
  [[nodiscard]] std::optional<FeltTick> take() noexcept;

 private:
  static constexpr std::size_t kCount = std::size_t{1} << 15;
  std::unique_ptr<std::array<FeltTick, kCount>> ticks_ =
      std::make_unique<std::array<FeltTick, kCount>>();
  std::atomic<std::uint64_t> written_{0}, taken_{0};
};

/// A model in the loop that also reports the ticks of its tool. Equal tools give the same as the
/// model alone, bit by bit.
class FeltWorld final : public haptics::ToolWorld {
 public:
  /// \param tick [s] of the loop
  FeltWorld(std::shared_ptr<const haptics::Playback> playback, double tick);

  void begin(double now) noexcept override;
  [[nodiscard]] haptics::Command try_tool(const Eigen::Vector3d& tool) noexcept override;
  void end() noexcept override { world_.end(); }

  /// The last try; `commanded` is not known here.
  [[nodiscard]] const FeltTick& felt() const noexcept { return felt_; }

 private:
  std::shared_ptr<const haptics::Playback> playback_;
  haptics::ModelWorld world_;
  FeltTick felt_;
};

/// The mouse as a device without motors. It passes commands, and the ticks of the world, to the
/// window. On the host's clock.
class MouseDevice final : public devices::Device {
 public:
  /// \param wishes from the thread of the window. All three must outlive the device.
  MouseDevice(const ToolMotion& motion, LatestValue<ToolWish>& wishes, const FeltWorld& world,
              TickFeed& feed);

  [[nodiscard]] const devices::DeviceDescription& description() const noexcept override {
    return description_;
  }
  [[nodiscard]] double now() const noexcept override { return clock_.now(); }
  void activate() override { clock_.activate(); }
  [[nodiscard]] bool read(devices::DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const devices::DeviceCommand& command) noexcept override;
  void stop() noexcept override { clock_.stop(); }

 private:
  haptics::TrajectoryDevice clock_;  // whose path rests
  devices::DeviceDescription description_;
  ToolMotion motion_;
  LatestValue<ToolWish>* wishes_;
  const FeltWorld* world_;
  TickFeed* feed_;
  bool is_read_ = false;  // since the last command
};

/// [s] of a tick of the window's loops.
inline constexpr double kLoopPeriod = 1e-3;

/// Options of the window's loops: with the safety layer, whose ramp is short, as nobody is pushed;
/// and without the virtual coupling, so that the tool is where the mouse or the path is.
[[nodiscard]] haptics::DeviceLoopOptions loop_options();

/// Returns what a path of the tool feels, tick by tick at 1 kHz, through the same loop.
[[nodiscard]] std::vector<FeltTick> felt_along(
    const std::shared_ptr<const haptics::Playback>& playback, haptics::TimedPath path);

/// A session that was recorded, computed again.
struct FeltSession {
  std::vector<FeltTick> ticks;
  haptics::LoopReplay replay;  ///< how it compares with the record
};
[[nodiscard]] FeltSession felt_again(const std::shared_ptr<const haptics::Playback>& playback,
                                     const haptics::LoopRecord& record);

}  // namespace palpate::view
