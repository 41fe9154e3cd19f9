// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

constexpr double kRigid = 1e-6;  // of the entries of R^T R: poses in single precision, six decimals

bool is_pose(const Eigen::Isometry3d& pose) {
  return pose.translation().allFinite() && is_rotation(pose.linear(), kRigid);
}

// True if the path of a tool in a tick stays out of a ball; false for places that are not finite.
bool passes(const Playback::Ball& ball, const Eigen::Vector3d& place, double moved) {
  const double nearest = ball.radius + moved;
  return (place - ball.center).squaredNorm() > nearest * nearest;
}

// Returns true if a tool touches, or if its force is still decreasing to zero after it has left
// (`PlaybackOptions::largest_jump`).
bool has_force(const Command& command) {
  return command.state != ContactState::free || !command.force.isZero(0);
}

// 0 for equal places, 1 from the distance `closest` on, with a continuous derivative.
double smooth_share(double distance, double closest) {
  if (!(distance < closest)) return 1;
  const double part = distance / closest;
  return part * part * (3 - 2 * part);
}

std::uint64_t next_scene_id() {
  static std::atomic<std::uint64_t> latest{0};
  return ++latest;
}

}  // namespace

const char* to_string(NearTools rule) {
  switch (rule) {
    case NearTools::independent:
      return "independent";
    case NearTools::fade:
      return "fade";
    case NearTools::refuse:
      return "refuse";
  }
  return "unknown";
}

SceneState& SceneState::operator=(const SceneState& other) {
  if (this == &other) return *this;
  scene_ = other.scene_;
  tick_ = other.tick_;
  pairs_ = other.pairs_;
  if (loops_.size() == other.loops_.size()) {
    // Those of tools that are away are many, large, and not used.
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      if (!pairs_[i].away) loops_[i] = other.loops_[i];
    }
  } else {
    loops_ = other.loops_;
  }
  poses_ = other.poses_;
  tools_ = other.tools_;
  strongest_ = other.strongest_;
  command_ = other.command_;
  return *this;
}

Scene::Scene(std::vector<SceneObject> objects, const SceneOptions& options)
    : objects_(std::move(objects)), options_(options), id_(next_scene_id()) {
  require("SceneOptions::closest_tools", options.closest_tools, at_least(0).finite(), "mm");
  require("SceneOptions::tick", options.tick, above(0).finite(), "s");
  require("SceneOptions::fade_ticks", options.fade_ticks, at_least(1));
  if (objects_.empty()) throw InvalidInput("Scene: there is no object; at least one is needed");
  std::set<std::string> names;
  for (const SceneObject& object : objects_) {
    if (object.name.empty()) throw InvalidInput("Scene: an object has no name");
    if (!names.insert(object.name).second) {
      throw InvalidInput("Scene: two objects have the name '" + object.name +
                         "'; names must be different");
    }
    if (!object.playback) throw InvalidInput("Scene: '" + object.name + "' has no playback");
    reaches_.push_back(object.playback->reach());
  }
}

SceneState Scene::start(int tools) const {
  require("Scene::start(): tools", tools, at_least(1));
  const auto tool_count = static_cast<std::size_t>(tools);
  SceneState state;
  state.scene_ = id_;
  state.pairs_.resize(tool_count * objects_.size());
  state.loops_.resize(state.pairs_.size());
  state.poses_.resize(objects_.size(), Eigen::Isometry3d::Identity());
  state.tools_.resize(tool_count, Eigen::Vector3d::Zero());
  state.strongest_.resize(tool_count);
  state.command_.tools.resize(tool_count);
  state.command_.objects.resize(objects_.size());
  return state;
}

// \param tool [mm] in the object's frame; not finite for a faulty tick.
void Scene::touch(std::size_t object, const Eigen::Vector3d& tool, SceneState::Pair& pair,
                  LoopState& loop) const noexcept {
  const Playback& playback = *objects_[object].playback;
  const Playback::Ball& reach = reaches_[object];
  if (pair.away) {
    // A tool that is away touches nothing, so that a fault costs no contact: it starts again.
    pair.has_last = pair.has_last && tool.allFinite();
    if (!tool.allFinite()) return;
    if (passes(reach, tool, pair.has_last ? (tool - pair.last).norm() : 0)) {
      pair.last = tool;
      pair.has_last = true;
      return;
    }
    loop = {};
    if (pair.has_last) static_cast<void>(playback.step(pair.last, loop));
    pair.away = false;
  }
  pair.command = playback.step(tool, loop, options_.tick);
  if (has_force(pair.command) || pair.command.held || !passes(reach, tool, 0)) return;
  pair.away = true;
  pair.last = tool;
  pair.has_last = true;
  pair.command = {};
}

// Sets the shares of the tools that touch an object.
void Scene::give_way(std::span<SceneState::Pair> pairs, std::uint64_t tick) const noexcept {
  for (SceneState::Pair& pair : pairs) {
    const bool touched = pair.touches;
    pair.touches = has_force(pair.command);
    if (pair.touches && !touched) {
      pair.since = tick;
      pair.share = 1;
    }
  }
  if (options_.near_tools == NearTools::independent) return;
  const double fastest = 1.0 / options_.fade_ticks;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    SceneState::Pair& later = pairs[i];
    if (!later.touches) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const SceneState::Pair& other = pairs[k];
      const bool earlier = other.since < later.since || (other.since == later.since && k < i);
      if (!other.touches || !earlier) continue;
      nearest = std::min(nearest, (other.command.contact - later.command.contact).norm());
    }
    double share = smooth_share(nearest, options_.closest_tools);
    if (options_.near_tools == NearTools::refuse && share < 1) share = 0;
    // A contact begins without force, so that its first share may be anything.
    const double least = later.since == tick ? 0 : later.share - fastest;
    later.share = std::min(later.share, std::max(share, least));
  }
}

const SceneCommand& Scene::step(std::span<const Eigen::Isometry3d> poses,
                                std::span<const Eigen::Vector3d> tools,
                                SceneState& state) const noexcept {
  SceneCommand& all = state.command_;
  if (state.scene_ != id_) {
    for (ToolCommand& tool : all.tools) tool = {.command = {.held = true}};
    for (ObjectLoad& object : all.objects) object = {.held = true};
    return all;
  }
  ++state.tick_;
  const Eigen::Vector3d nowhere =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const std::size_t count = all.tools.size();
  const auto is_given = [&](std::size_t t) { return t < tools.size() && tools[t].allFinite(); };
  for (std::size_t t = 0; t < count; ++t) {
    if (is_given(t)) state.tools_[t] = tools[t];
    state.strongest_[t] = -1;
    all.tools[t] = {.command = {.contact = state.tools_[t], .held = !is_given(t)}};
  }
  for (std::size_t o = 0; o < objects_.size(); ++o) {
    const bool has_pose = o < poses.size() && is_pose(poses[o]);
    if (has_pose) state.poses_[o] = poses[o];
    const Eigen::Isometry3d& T_world_object = state.poses_[o];
    const std::span<SceneState::Pair> pairs(state.pairs_.data() + o * count, count);
    for (std::size_t t = 0; t < count; ++t) {
      const Eigen::Vector3d tool = has_pose && is_given(t)
                                       ? Eigen::Vector3d(T_world_object.linear().transpose() *
                                                         (tools[t] - T_world_object.translation()))
                                       : nowhere;
      touch(o, tool, pairs[t], state.loops_[o * count + t]);
    }
    give_way(pairs, state.tick_);

    ObjectLoad load{.held = !has_pose};
    for (std::size_t t = 0; t < count; ++t) {
      const SceneState::Pair& pair = pairs[t];
      ToolCommand& tool = all.tools[t];
      if (pair.away) continue;
      tool.command.held |= pair.command.held;
      tool.command.limited |= pair.command.limited;
      tool.command.started_inside |= pair.command.started_inside;
      const Eigen::Vector3d force = T_world_object.linear() * (pair.share * pair.command.force);
      tool.command.force += force;
      load.force -= force;
      // The user and the object meet where the tool is, on the deformed surface.
      load.torque -= (state.tools_[t] - T_world_object.translation()).cross(force);
      // Of the whole force, so that it is known what a contact without a share touches.
      const double size = pair.command.force.norm();
      if (pair.command.state == ContactState::free || !(size > state.strongest_[t])) continue;
      state.strongest_[t] = size;
      tool.object = static_cast<int>(o);
      tool.share = pair.share;
      tool.command.contact = T_world_object * pair.command.contact;
      tool.command.state = pair.command.state;
    }
    all.objects[o] = load;
  }
  return all;
}

}  // namespace palpate::haptics
