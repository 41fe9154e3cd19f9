// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/play_scene.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ostream>
#include <regex>
#include <span>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/error_statistics.h"
#include "shared/output_checks.h"
#include "shared/played_model.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

constexpr const char* kFiguresFile = "figures.json";

/// Contacts and forces of a tool over all ticks.
struct ToolFigures {
  std::array<int, 3> ticks{};  ///< by ContactState
  int faded = 0;               ///< ticks in which another tool was too near
  double largest_force = 0;    ///< [N]
};

ToolFigures figures_of(std::span<const haptics::SceneTracePoint> trace) {
  ToolFigures figures;
  for (const haptics::SceneTracePoint& point : trace) {
    ++figures.ticks[static_cast<std::size_t>(point.felt.state)];
    figures.faded += point.share < 1;
    figures.largest_force = std::max(figures.largest_force, point.felt.force.norm());
  }
  return figures;
}

/// Duration of the ticks [us], played once more.
geometry::ErrorStatistics time_ticks(const haptics::Scene& scene,
                                     const haptics::SceneMotion& motion) {
  using Clock = std::chrono::steady_clock;
  haptics::SceneState state = scene.start(static_cast<int>(motion.tools.size()));
  std::vector<double> times;
  for (std::size_t tick = 0, ticks = haptics::tick_count(motion); tick < ticks; ++tick) {
    const haptics::SceneInput input = haptics::input_at(motion, tick);
    const Clock::time_point start = Clock::now();
    scene.step(input.poses, input.tools, state);
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  return geometry::error_statistics(std::move(times));
}

}  // namespace

void check_ways(const haptics::SceneFile& file, std::optional<std::size_t> device,
                const fs::path& path) {
  for (std::size_t t = 0; t < file.tools.size(); ++t) {
    if (t == device || !file.trajectories[t].empty()) continue;
    throw InvalidInput(fmt::format(
        "{}: tool '{}' has no 'trajectory'; it needs one, unless a device moves it (--device, "
        "--tool)",
        path.string(), file.tools[t]));
  }
}

void write_scene_traces(const fs::path& folder, const haptics::SceneFile& file,
                        const haptics::Scene& scene, const haptics::SceneTrace& trace,
                        const Json& figures) {
  const std::regex own(R"(figures\.json|(tool|object)_[\w-]+\.csv)");
  write_folder(folder, own_entries(folder, kFiguresFile, own), [&](const fs::path& place) {
    write_file(place / kFiguresFile, [&](std::ostream& out) { out << figures.dump(2) << '\n'; });
    for (std::size_t t = 0; t < trace.tools.size(); ++t)
      haptics::write_tool_trace(place / ("tool_" + file.tools[t] + ".csv"), scene, trace.tools[t]);
    for (std::size_t o = 0; o < trace.objects.size(); ++o)
      haptics::write_load_trace(place / ("object_" + file.objects[o] + ".csv"), trace.objects[o]);
  });
}

void play_scene(const Settings& settings, const fs::path& path, const fs::path& record) {
  const haptics::SceneFile file = haptics::read_scene(path);
  check_ways(file, std::nullopt, path);
  if (!record.empty()) {
    std::vector<fs::path> inputs = file.sources;
    inputs.insert(inputs.end(), file.models.begin(), file.models.end());
    check_output_folder(inputs, record);
  }
  const haptics::Scene scene = haptics::make_scene(file);
  tell_unknown_friction(file, scene);
  const haptics::SceneTrace trace = haptics::play(scene, file.motion);
  const geometry::ErrorStatistics times = time_ticks(scene, file.motion);

  Json tools = Json::array(), objects = Json::array();
  std::string prose = fmt::format("{} ticks at {:g} Hz", trace.tools[0].size(), file.motion.rate);
  int touching = 0;
  for (std::size_t t = 0; t < file.tools.size(); ++t) {
    const ToolFigures found = figures_of(trace.tools[t]);
    tools.push_back({{"name", file.tools[t]},
                     {"free", found.ticks[0]},
                     {"stick", found.ticks[1]},
                     {"slip", found.ticks[2]},
                     {"largest_force", found.largest_force},
                     {"faded", found.faded}});
    prose += fmt::format("\nTool {}: {} free, {} stick, {} slip; largest force {}", file.tools[t],
                         found.ticks[0], found.ticks[1], found.ticks[2],
                         newtons(found.largest_force, 3));
    touching += found.ticks[1] + found.ticks[2];
    if (found.faded > 0) {
      spdlog::warn(
          "tool '{}' touches an object within {:g} mm of another tool: its force is reduced in {} "
          "ticks. A model knows one contact at a time (docs/trade-playback.md).",
          file.tools[t], file.options.closest_tools, found.faded);
    }
  }
  for (std::size_t o = 0; o < file.objects.size(); ++o) {
    double force = 0, torque = 0;
    for (const haptics::LoadPoint& point : trace.objects[o]) {
      force = std::max(force, point.load.force.norm());
      torque = std::max(torque, point.load.torque.norm());
    }
    objects.push_back(
        {{"name", file.objects[o]}, {"largest_force", force}, {"largest_torque", torque}});
    prose += fmt::format("\nObject {}: largest load {}, {:.1f} N mm about its origin",
                         file.objects[o], newtons(force, 3), torque);
  }
  const Json figures{
      {"steps", trace.tools[0].size()},
      {"rate", file.motion.rate},
      {"tools", tools},
      {"objects", objects},
      {"us_per_step", {{"median", times.median}, {"p90", times.p90}, {"max", times.max}}}};
  if (!record.empty()) {
    write_scene_traces(record, file, scene, trace, figures);
  }
  print(settings, figures,
        fmt::format(
            "{}\nA tick takes {:.1f} us (median), 90 % within {:.1f} us, at most {:.1f} us.{}",
            prose, times.median, times.p90, times.max,
            record.empty() ? "" : "\nWritten to " + record.string()));
  if (touching == 0) {
    spdlog::warn(
        "no tool ever touches an object: a trajectory must cross the surface of an object from "
        "outside, all in the frame of the world and in mm.");
  }
}

}  // namespace palpate::apps
