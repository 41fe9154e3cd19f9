// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "felt_loop.h"

#include <cmath>
#include <utility>

#include "palpate/haptics/timed_path.h"

namespace palpate::view {
namespace {

/// [N] No motor limits what is shown: the safety layer does.
constexpr double kHighestForce = 1000;

/// [s] of growth of the force when a press begins.
constexpr double kShortRamp = 0.05;

haptics::TimedPath resting_path() {
  return haptics::TimedPath({{.time = 0, .tool = Eigen::Vector3d::Zero()}});
}

haptics::TrajectoryDeviceOptions path_options(bool real_time) {
  return {.period = kLoopPeriod, .real_time = real_time, .highest_force = kHighestForce};
}

}  // namespace

void TickFeed::put(const FeltTick& tick) noexcept {
  const std::uint64_t place = written_.load(std::memory_order_relaxed);
  if (place - taken_.load(std::memory_order_acquire) >= kCount) return;
  (*ticks_)[place % kCount] = tick;
  written_.store(place + 1, std::memory_order_release);
}

std::optional<FeltTick> TickFeed::take() noexcept {
  const std::uint64_t place = taken_.load(std::memory_order_relaxed);
  if (place == written_.load(std::memory_order_acquire)) return std::nullopt;
  const FeltTick tick = (*ticks_)[place % kCount];
  taken_.store(place + 1, std::memory_order_release);
  return tick;
}

FeltWorld::FeltWorld(std::shared_ptr<const haptics::Playback> playback, double tick)
    : playback_(std::move(playback)), world_(tick) {
  world_.exchange(*playback_);
}

void FeltWorld::begin(double now) noexcept {
  felt_.time = now;
  world_.begin(now);
}

haptics::Command FeltWorld::try_tool(const Eigen::Vector3d& tool) noexcept {
  haptics::Command command = world_.try_tool(tool);
  felt_.tool = tool;
  felt_.contact = command.contact;
  felt_.force = command.force;
  felt_.state = command.state;
  return command;
}

MouseDevice::MouseDevice(const ToolMotion& motion, LatestValue<ToolWish>& wishes,
                         const FeltWorld& world, TickFeed& feed)
    : clock_(resting_path(), path_options(true)),
      description_(clock_.description()),
      motion_(motion),
      wishes_(&wishes),
      world_(&world),
      feed_(&feed) {
  description_.name = "mouse";
}

bool MouseDevice::read(devices::DeviceState& state) noexcept {
  if (!clock_.read(state)) return false;
  state.tip = motion_.tick(wishes_->read());
  is_read_ = true;
  return true;
}

bool MouseDevice::write(const devices::DeviceCommand& command) noexcept {
  // The last command, which ends the loop, belongs to no tick.
  if (is_read_) {
    FeltTick tick = world_->felt();
    tick.commanded = command.force;
    feed_->put(tick);
  }
  is_read_ = false;
  return clock_.write(command);
}

haptics::DeviceLoopOptions loop_options() {
  haptics::DeviceLoopOptions options;
  options.safety.ramp = kShortRamp;
  options.coupling.on = false;
  return options;
}

std::vector<FeltTick> felt_along(const std::shared_ptr<const haptics::Playback>& playback,
                                 haptics::TimedPath path) {
  const auto count = static_cast<long long>(std::ceil(path.duration() / kLoopPeriod)) + 1;
  haptics::TrajectoryDevice device(std::move(path), path_options(false));
  device.activate();
  haptics::DeviceLoop loop(device.description(), loop_options());
  FeltWorld world(playback, kLoopPeriod);
  std::vector<FeltTick> ticks;
  for (long long i = 0; i < count; ++i) {
    haptics::TickInput input;
    input.answered = device.read(input.state);
    input.now = device.now();
    const haptics::TickOutput output = loop.tick(world, input);
    ticks.push_back(world.felt());
    ticks.back().commanded = output.command.force;
  }
  return ticks;
}

FeltSession felt_again(const std::shared_ptr<const haptics::Playback>& playback,
                       const haptics::LoopRecord& record) {
  FeltSession session;
  FeltWorld world(playback, record.device.period);
  session.replay = haptics::replay(record, world, [&] {
    session.ticks.push_back(world.felt());
    session.ticks.back().commanded =
        Eigen::Vector3d::Map(record.ticks[session.ticks.size() - 1].force.data());
  });
  return session;
}

}  // namespace palpate::view
