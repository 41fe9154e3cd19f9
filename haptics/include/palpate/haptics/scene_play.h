// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/pose_path.h"
#include "palpate/haptics/scene.h"
#include "palpate/haptics/timed_path.h"

namespace palpate::haptics {

/// The paths of all objects and tools of a scene, on one clock. A path with a single place stands
/// still.
struct SceneMotion {
  std::vector<PosePath> objects;
  std::vector<TimedPath> tools;
  double rate = 1000;  ///< [Hz] of the ticks; > 0
};

/// The input of `Scene::step` in one tick.
struct SceneInput {
  double time = 0;  ///< [s]
  std::vector<Eigen::Isometry3d> poses;
  std::vector<Eigen::Vector3d> tools;  ///< [mm]
};

/// Number of ticks from the first point of any path to the last one of any.
/// \throws InvalidInput if a tool has no path, the rate is not above 0, or ticks are 1e7 or more.
[[nodiscard]] std::size_t tick_count(const SceneMotion& motion);
[[nodiscard]] SceneInput input_at(const SceneMotion& motion, std::size_t tick);
/// The same at any time [s]. Real-time safe if `input` is of this motion.
void set_input(const SceneMotion& motion, double time, SceneInput& input);

/// The command for a tool in one tick.
struct SceneTracePoint {
  TracePoint felt;
  int object = -1;   ///< as in `ToolCommand`
  double share = 1;  ///< as in `ToolCommand`
};
/// The load of the tools on an object in one tick.
struct LoadPoint {
  double time = 0;  ///< [s]
  ObjectLoad load;
};
struct SceneTrace {
  std::vector<std::vector<SceneTracePoint>> tools;  ///< of each tool, by tick
  std::vector<std::vector<LoadPoint>> objects;      ///< of each object, by tick
};

/// Plays a scene along given paths, beginning with a new state.
/// \throws InvalidInput if there is not one path for each object, or none of a tool.
[[nodiscard]] SceneTrace play(const Scene& scene, const SceneMotion& motion);

/// Writes a CSV file with the columns `t,x,y,z,cx,cy,cz,fx,fy,fz,state,object,share`, all in the
/// world; `object` is its name or empty. The numbers read back exactly.
/// \throws OutputError if the file cannot be written.
void write_tool_trace(const std::filesystem::path& path, const Scene& scene,
                      std::span<const SceneTracePoint> trace);
/// Writes a CSV file with the columns `t,fx,fy,fz,tx,ty,tz` [s, N, N mm]: an `ObjectLoad`.
/// \throws OutputError if the file cannot be written.
void write_load_trace(const std::filesystem::path& path, std::span<const LoadPoint> trace);

}  // namespace palpate::haptics
