// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_play.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "palpate/probing/csv.h"

namespace palpate::haptics {
namespace {

constexpr std::array<std::string_view, 13> kToolColumns = {
    "t", "x", "y", "z", "cx", "cy", "cz", "fx", "fy", "fz", "state", "object", "share"};
constexpr std::array<std::string_view, 7> kLoadColumns = {"t", "fx", "fy", "fz", "tx", "ty", "tz"};
// [ticks] A last tick that is missed by less, by rounding, counts.
constexpr double kTickRounding = 1e-6;
constexpr double kMostTicks = 1e7;  // whose trace fits into memory

struct TimeSpan {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();
};

TimeSpan time_span(const SceneMotion& motion) {
  TimeSpan span;
  const auto add = [&](double begin, double end) {
    span.begin = std::min(span.begin, begin);
    span.end = std::max(span.end, end);
  };
  for (const PosePath& path : motion.objects) add(path.begin(), path.end());
  for (const TimedPath& path : motion.tools) add(path.begin(), path.begin() + path.duration());
  return span;
}

void write_vectors(std::ostream& out, std::initializer_list<Eigen::Vector3d> vectors) {
  for (const Eigen::Vector3d& v : vectors) {
    for (const double value : v) out << ',' << probing::to_text(value);
  }
}

}  // namespace

std::size_t tick_count(const SceneMotion& motion) {
  require("SceneMotion::rate", motion.rate, above(0).finite(), "Hz");
  if (motion.tools.empty()) {
    throw InvalidInput("SceneMotion: there is no tool; at least one is needed");
  }
  const TimeSpan span = time_span(motion);
  const double ticks = (span.end - span.begin) * motion.rate + kTickRounding;
  if (!(ticks < kMostTicks)) {
    throw InvalidInput("SceneMotion: the ways take " + std::to_string(span.end - span.begin) +
                       " s, from the first time of any to the last one; they must take less than "
                       "1e7 ticks: the times may not be in s");
  }
  return 1 + static_cast<std::size_t>(ticks);
}

SceneInput input_at(const SceneMotion& motion, std::size_t tick) {
  SceneInput input;
  set_input(motion, time_span(motion).begin + static_cast<double>(tick) / motion.rate, input);
  return input;
}

void set_input(const SceneMotion& motion, double time, SceneInput& input) {
  input.time = time;
  input.poses.resize(motion.objects.size());
  input.tools.resize(motion.tools.size());
  for (std::size_t i = 0; i < motion.objects.size(); ++i)
    input.poses[i] = motion.objects[i].pose(time);
  for (std::size_t i = 0; i < motion.tools.size(); ++i)
    input.tools[i] = motion.tools[i].position(time - motion.tools[i].begin());
}

SceneTrace play(const Scene& scene, const SceneMotion& motion) {
  if (motion.objects.size() != scene.objects().size()) {
    throw InvalidInput("play(): there are ways of " + std::to_string(motion.objects.size()) +
                       " objects; the scene has " + std::to_string(scene.objects().size()));
  }
  const std::size_t ticks = tick_count(motion);
  SceneTrace trace;
  trace.tools.resize(motion.tools.size());
  trace.objects.resize(motion.objects.size());
  SceneState state = scene.start(static_cast<int>(motion.tools.size()));
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const SceneInput input = input_at(motion, tick);
    const SceneCommand& all = scene.step(input.poses, input.tools, state);
    for (std::size_t t = 0; t < trace.tools.size(); ++t) {
      const auto& [command, object, share] = all.tools[t];
      trace.tools[t].push_back(
          {{input.time, input.tools[t], command.contact, command.force, command.state},
           object,
           share});
    }
    for (std::size_t o = 0; o < trace.objects.size(); ++o)
      trace.objects[o].push_back({input.time, all.objects[o]});
  }
  return trace;
}

void write_tool_trace(const std::filesystem::path& path, const Scene& scene,
                      std::span<const SceneTracePoint> trace) {
  write_file(path, [&](std::ostream& out) {
    probing::write_csv_header(out, kToolColumns);
    for (const auto& [felt, object, share] : trace) {
      out << probing::to_text(felt.time);
      write_vectors(out, {felt.tool, felt.contact, felt.force});
      out << ',' << to_string(felt.state) << ',';
      if (object >= 0) out << scene.objects()[static_cast<std::size_t>(object)].name;
      out << ',' << probing::to_text(share) << '\n';
    }
  });
}

void write_load_trace(const std::filesystem::path& path, std::span<const LoadPoint> trace) {
  write_file(path, [&](std::ostream& out) {
    probing::write_csv_header(out, kLoadColumns);
    for (const LoadPoint& point : trace) {
      out << probing::to_text(point.time);
      write_vectors(out, {point.load.force, point.load.torque});
      out << '\n';
    }
  });
}

}  // namespace palpate::haptics
