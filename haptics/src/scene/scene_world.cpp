// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_world.h"

#include <limits>
#include <string>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

const Scene& checked(const std::shared_ptr<const Scene>& scene, const SceneMotion& motion,
                     std::size_t tool) {
  if (!scene) throw InvalidInput("SceneWorld: there is no scene");
  static_cast<void>(tick_count(motion));
  if (motion.objects.size() != scene->objects().size()) {
    throw InvalidInput("SceneWorld: there are ways of " + std::to_string(motion.objects.size()) +
                       " objects; the scene has " + std::to_string(scene->objects().size()));
  }
  if (tool >= motion.tools.size()) {
    throw InvalidInput("SceneWorld: the device has tool " + std::to_string(tool) + "; there are " +
                       std::to_string(motion.tools.size()) + ", from 0");
  }
  return *scene;
}

}  // namespace

SceneWorld::SceneWorld(std::shared_ptr<const Scene> scene, SceneMotion motion, std::size_t tool)
    : scene_(std::move(scene)), motion_(std::move(motion)), tool_(tool) {
  state_ = checked(scene_, motion_, tool).start(static_cast<int>(motion_.tools.size()));
  trial_ = state_;
  input_ = input_at(motion_, 0);
  begin_ = input_.time;
}

void SceneWorld::begin(double now) noexcept {
  if (!zero_) zero_ = now;
  set_input(motion_, begin_ + (now - *zero_), input_);
  tried_ = false;
}

Command SceneWorld::try_tool(const Eigen::Vector3d& place) noexcept {
  tried_ = true;
  trial_ = state_;  // of the same sizes: without an allocation
  input_.tools[tool_] = place;
  return scene_->step(input_.poses, input_.tools, trial_).tools[tool_].command;
}

void SceneWorld::end() noexcept {
  if (tried_) {
    place_ = input_.tools[tool_];
    has_place_ = true;
  } else {
    // Before its first place the tool is nowhere, and touches nothing.
    const Eigen::Vector3d nowhere =
        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    static_cast<void>(try_tool(has_place_ ? place_ : nowhere));
  }
  std::swap(state_, trial_);
}

SceneTrace trace_of(const LoopRecord& record, SceneWorld& world) {
  SceneTrace trace;
  trace.tools.resize(world.input().tools.size());
  trace.objects.resize(world.input().poses.size());
  const std::vector<TracePoint> commanded = trace_of(record);
  std::size_t tick = 0;
  static_cast<void>(replay(record, world, [&] {
    const SceneInput& input = world.input();
    for (std::size_t t = 0; t < trace.tools.size(); ++t) {
      const auto& [command, object, share] = world.command().tools[t];
      TracePoint felt{input.time, input.tools[t], command.contact, command.force, command.state};
      if (t == world.tool()) {
        felt = commanded[tick];
        felt.time = input.time;
      }
      trace.tools[t].push_back({felt, object, share});
    }
    for (std::size_t o = 0; o < trace.objects.size(); ++o)
      trace.objects[o].push_back({input.time, world.command().objects[o]});
    ++tick;
  }));
  return trace;
}

}  // namespace palpate::haptics
