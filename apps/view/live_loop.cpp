// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "live_loop.h"

namespace palpate::view {
namespace {

/// [mm] A tool that is this far from everything is free, and its motion from there is a jump for
/// playback, whatever the size of the object.
constexpr double kAside = 1000;

Eigen::Vector3d place_aside(const haptics::Playback& playback, double diagonal) {
  const haptics::Playback::Ball& reach = playback.reach();
  return reach.center + Eigen::Vector3d(0, 0, reach.radius + diagonal + kAside);
}

}  // namespace

LiveLoop::LiveLoop(const std::shared_ptr<const haptics::Playback>& playback,
                   const LiveLoopOptions& options)
    : world_(std::make_shared<FeltWorld>(playback, kLoopPeriod)),
      device_(ToolMotion(options.diagonal, place_aside(*playback, options.diagonal)), wishes_,
              *world_, feed_),
      run_(std::make_unique<haptics::DeviceRun>(
          device_, world_, loop_options(),
          haptics::RunOptions{.record = options.record, .session = options.session})) {}

haptics::RunReport LiveLoop::finish() {
  run_->stop();
  return run_->finish();
}

}  // namespace palpate::view
