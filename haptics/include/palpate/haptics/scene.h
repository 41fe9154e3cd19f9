// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/playback.h"

namespace palpate::haptics {

/// An object of a scene. Several may share a `Playback`.
struct SceneObject {
  std::string name;
  std::shared_ptr<const Playback> playback;
};

/// The rule for two tools that touch one object near each other. A model knows one contact at a
/// time (thesis 6.2.4.1); the contact that began later gives way.
enum class NearTools {
  independent,  ///< nothing: each tool feels the object as if it were alone
  fade,   ///< the later contact keeps a share of its force, which falls to 0 with the distance
  refuse  ///< the later contact keeps nothing
};

/// "independent", "fade" or "refuse"
[[nodiscard]] const char* to_string(NearTools rule);

struct SceneOptions {
  NearTools near_tools = NearTools::fade;
  /// [mm] >= 0. Contacts with one object are near if the distance of their places on the undeformed
  /// surface is less. From the default on, balls of 5 mm pressed 2.5 mm into solids of finite
  /// elements feel forces that are wrong by less than 5 %; along a stretched membrane no distance
  /// is enough: see docs/trade-playback.md.
  double closest_tools = 25;
  /// >= 1. A share falls from 1 to 0 in at least this number of ticks.
  int fade_ticks = 20;
  /// [s] > 0. Time between two ticks; counts only for objects whose force depends on the rate.
  double tick = 1e-3;
};

/// The command for one tool in one tick.
struct ToolCommand {
  /// The force is the sum over all objects; contact and state are those of `object`, in the world;
  /// a flag is set if it is for some object.
  Command command;
  int object = -1;   ///< the one that pushes the tool most; -1: the tool touches none
  double share = 1;  ///< of its force that is commanded; below 1: another tool is or was near
};

/// The load of the tools on an object in one tick, in the world.
struct ObjectLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N] on the object
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N mm] on it, about its frame's origin
  bool held = false;                                 ///< its pose was not usable
};

/// The result of a tick.
struct SceneCommand {
  std::vector<ToolCommand> tools;
  std::vector<ObjectLoad> objects;
};

/// The state of a scene with its tools between two ticks. A copy continues identically.
class SceneState {
 public:
  SceneState() = default;
  SceneState(const SceneState&) = default;
  SceneState(SceneState&&) = default;
  SceneState& operator=(SceneState&&) = default;
  /// Between states of one scene and as many tools: real-time safe.
  SceneState& operator=(const SceneState& other);
  ~SceneState() = default;

  /// Of the last tick.
  [[nodiscard]] const SceneCommand& command() const noexcept { return command_; }

 private:
  friend class Scene;
  /// A tool and an object.
  struct Pair {
    /// [mm] of the tool in the object's frame at the last tick.
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    bool has_last = false;
    /// The tool is away from the object, and its `LoopState` is not used.
    bool away = true;
    bool touches = false;     ///< from the touch until its force has ended
    std::uint64_t since = 0;  ///< the tick of the touch
    double share = 1;
    Command command;  ///< in the object's frame
  };
  std::uint64_t scene_ = 0, tick_ = 0;
  // Pairs and loops: all tools with the first object, then with the second one, ...
  std::vector<Pair> pairs_;
  std::vector<LoopState> loops_;
  std::vector<Eigen::Isometry3d> poses_;  ///< the last usable ones
  std::vector<Eigen::Vector3d> tools_;    ///< [mm] the last usable ones
  std::vector<double> strongest_;         ///< [N] by tool
  SceneCommand command_;
};

/// Several objects, which may move, and several tools, at 1 kHz or more.
///
/// Each tool touches each object as in `Playback`, in the frame of the object: only the motion of
/// one relative to the other counts. An object whose ball (`Playback::reach`) is far from the path
/// of a tool costs two transformations. Contacts of several tools with one object are independent,
/// and near ones give way (`NearTools`). Like `Playback`, a scene gives the users no more energy
/// than they and the movers of the objects put in, apart from its credit: a share does not rise
/// before its tool has left the object.
class Scene {
 public:
  /// \throws InvalidInput without objects, for one without a playback, for names that are empty or
  /// occur twice, or for an option outside its range.
  explicit Scene(std::vector<SceneObject> objects, const SceneOptions& options = {});

  [[nodiscard]] const std::vector<SceneObject>& objects() const noexcept { return objects_; }

  /// The state before the first tick. Allocates everything that `step` needs.
  /// \throws InvalidInput without tools.
  [[nodiscard]] SceneState start(int tools) const;

  /// Computes one tick. Real-time safe, and thread-safe with one state per thread, like
  /// `Playback::step`. Forces are finite, and do not depend on the order of objects or tools except
  /// by rounding, and for tools that touch in the same tick: then the first one is the earlier.
  /// \param poses T_world_object of each object. One that is missing, not finite or not rigid to
  /// 1e-6 is a faulty tick (`PlaybackOptions::hold_ticks`) for this object.
  /// \param tools [mm] in the world. One that is missing or not finite is a faulty tick for it.
  /// \param state of this scene; of another one: all is held, without force.
  /// \return `state.command()`
  const SceneCommand& step(std::span<const Eigen::Isometry3d> poses,
                           std::span<const Eigen::Vector3d> tools,
                           SceneState& state) const noexcept;

 private:
  std::vector<SceneObject> objects_;
  std::vector<Playback::Ball> reaches_;
  SceneOptions options_;
  std::uint64_t id_;

  void touch(std::size_t object, const Eigen::Vector3d& tool, SceneState::Pair& pair,
             LoopState& loop) const noexcept;
  void give_way(std::span<SceneState::Pair> pairs, std::uint64_t tick) const noexcept;
};

}  // namespace palpate::haptics
