// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/play_device.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/device_call.h"
#include "models/play_scene.h"
#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/haptics/device_run.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/scene_file.h"
#include "palpate/haptics/scene_world.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/probing/arm_setup.h"
#include "shared/inputs.h"
#include "shared/interrupts.h"
#include "shared/output_checks.h"
#include "shared/played_model.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// A scene in which a device moves a tool.
struct SceneOfDevice {
  haptics::SceneFile file;
  std::size_t tool = 0;          ///< of the device
  std::vector<fs::path> inputs;  ///< files and folders that were read
};

/// Returns the inputs of a scene's session: the path of each file and model, and its fingerprint.
Json prints_of(const SceneOfDevice& scene) {
  Json prints = Json::array();
  for (const fs::path& path : scene.file.sources)
    prints.push_back({{"path", path.string()}, {"fingerprint", file_fingerprint(path)}});
  for (const fs::path& path : scene.file.models)
    prints.push_back({{"path", path.string()}, {"fingerprint", print_of_model(path)}});
  return prints;
}

void report_replay(const Settings& settings, const fs::path& session,
                   const haptics::LoopReplay& again) {
  if (again.different > 0) {
    throw Error(
        fmt::format("{}: the replay differs in {} of {} ticks, first in tick {}: another version "
                    "of the program computed the session",
                    session.string(), again.different, again.ticks, again.first_different));
  }
  print(settings, {{"replayed", again.ticks}, {"different", again.different}},
        fmt::format("{} ticks replayed; every command and contact is the same to the bit",
                    again.ticks));
}

/// Returns the text that the replay of a session of the loop needs: its models.
std::string session_of(const DeviceCall& call) {
  std::vector<fs::path> models = {call.model};
  if (!call.exchange.empty()) models.push_back(call.exchange);
  return session_text(models, call.playback);
}

/// \param tool its name; empty: the first one. \throws FileError, or InvalidInput for another name.
SceneOfDevice read_scene_of_device(const fs::path& path, const std::string& tool) {
  SceneOfDevice scene{.file = haptics::read_scene(path), .inputs = {}};
  const std::vector<std::string>& tools = scene.file.tools;
  if (!tool.empty()) {
    const auto found = std::ranges::find(tools, tool);
    if (found == tools.end()) {
      throw InvalidInput(fmt::format("--tool: {} has no tool '{}'; it has {}", path.string(), tool,
                                     fmt::join(tools, ", ")));
    }
    scene.tool = static_cast<std::size_t>(found - tools.begin());
  }
  check_ways(scene.file, scene.tool, path);
  scene.inputs = scene.file.sources;
  scene.inputs.insert(scene.inputs.end(), scene.file.models.begin(), scene.file.models.end());
  return scene;
}

std::string session_of(const SceneOfDevice& scene) {
  const Json session = {{"scene", prints_of(scene)}, {"tool", scene.file.tools[scene.tool]}};
  return session.dump(-1, ' ', false, Json::error_handler_t::replace);  // paths need not be Unicode
}

/// The scene before its first tick, with ticks of the device [s].
/// \throws InvalidInput naming a model that cannot be felt.
std::shared_ptr<haptics::SceneWorld> world_of(const SceneOfDevice& scene, double tick) {
  haptics::SceneFile file = scene.file;
  file.options.tick = tick;
  return std::make_shared<haptics::SceneWorld>(
      std::make_shared<const haptics::Scene>(haptics::make_scene(file, playable_model)),
      scene.file.motion, scene.tool);
}

haptics::DeviceLoopOptions loop_options(const DeviceCall& call) {
  haptics::DeviceLoopOptions options;
  if (!call.pose.empty()) options.T_world_device = read_pose(call.pose);
  options.scale = call.scale;
  for (const unsigned button : call.clutch_buttons) options.clutch_buttons |= 1U << button;
  options.safety = call.safety;
  options.coupling = call.coupling;
  return options;
}

Json figures_of(const DeviceCall& call, const haptics::RunReport& report) {
  Json safety;
  for (std::size_t i = 0; i < report.actions.size(); ++i) {
    std::string key(devices::safety_words()[i]);
    std::ranges::replace(key, ' ', '_');
    safety[key] = report.actions[i];
  }
  return {{"device", call.device},
          {"steps", report.time.ticks},
          {"free", report.states[0]},
          {"stick", report.states[1]},
          {"slip", report.states[2]},
          {"largest_force", report.largest_force},
          {"largest_displacement", report.largest_displacement},
          {"rate", report.time.rate},
          {"late", report.time.late},
          {"us_per_step",
           {{"p50", report.time.p50}, {"p999", report.time.p999}, {"max", report.time.largest}}},
          {"real_time", call.real_time && report.not_real_time.empty()},
          {"memory_locked", report.memory_locked},
          {"coupling_stiffness", report.coupling_stiffness},
          {"given_energy", report.given.in_touches},
          {"touches", report.given.touches},
          {"giving_touches", report.given.giving},
          {"exchanges", report.exchanges},
          {"safety", safety}};
}

std::string energy_in_words(const haptics::GivenEnergy& given) {
  if (given.giving == 0) return "no energy was returned to the user";
  return fmt::format("{:.3f} N mm were returned to the user in {} of {} touches", given.in_touches,
                     given.giving, given.touches);
}

/// How far a simulated hand came. \param on_path [mm] largest displacement where its path leads; 0:
/// it has none, or touches nothing.
std::string reach_in_words(const DeviceCall& call, const haptics::RunReport& report,
                           double on_path) {
  if (on_path == 0) return "";
  const double share = report.largest_displacement / on_path;
  return fmt::format("\nThe {} {}: largest displacement {:.1f} mm, {:.0f} % of that on its path",
                     call.device == kHeldArm ? "held arm" : "hand",
                     share < 0.995 ? "gave way" : "held", report.largest_displacement, 100 * share);
}

std::string prose_of(const DeviceCall& call, const haptics::RunReport& report, double on_path) {
  std::string safety;
  for (std::size_t i = 0; i < report.actions.size(); ++i) {
    if (report.actions[i] == 0) continue;
    safety += fmt::format("{}{} {}", safety.empty() ? "" : ", ", devices::safety_words()[i],
                          report.actions[i]);
  }
  return fmt::format(
      "{} ticks at {:.0f} Hz: {} free, {} stick, {} slip; largest force {}; {} late\n"
      "A tick takes {:.1f} us (median), {:.1f} us (99.9 %), at most {:.1f} us\n"
      "{}; {}{}\n"
      "Safety, in ticks: {}{}{}",
      report.time.ticks, report.time.rate, report.states[0], report.states[1], report.states[2],
      newtons(report.largest_force, 3), report.time.late, report.time.p50, report.time.p999,
      report.time.largest,
      std::isfinite(report.coupling_stiffness)
          ? fmt::format("Virtual coupling of {:.3g} N/mm", report.coupling_stiffness)
          : std::string("No virtual coupling"),
      energy_in_words(report.given), reach_in_words(call, report, on_path),
      safety.empty() ? "nothing" : safety,
      report.exchanges > 0 ? fmt::format("\n{} exchange of the model", report.exchanges) : "",
      call.session.empty() ? "" : "\nRecorded in " + call.session.string());
}

void warn_of_run(const DeviceCall& call, const haptics::RunReport& report,
                 const devices::DeviceDescription& device) {
  if (!report.not_real_time.empty()) {
    spdlog::warn(
        "no real-time scheduling (SCHED_FIFO): {}; the loop runs with ordinary priority and may be "
        "late. Allow it with a limit 'rtprio' in /etc/security/limits.conf.",
        report.not_real_time);
  }
  if (call.coupling.on && !call.coupling.stiffness && device.damping == 0 &&
      is_driver(call.device)) {
    spdlog::warn(
        "{} does not declare its damping: {} N s/mm (--coupling-damping) are assumed for the "
        "virtual coupling.",
        call.device, call.coupling.least_damping);
  }
  if (report.refused > 0) spdlog::warn("{} commands were not taken.", report.refused);
}

/// The functions that begin the loop and, after it, write its trace.
struct PlayedLoop {
  std::string session;  ///< text that a replay needs
  std::function<std::unique_ptr<haptics::DeviceRun>(devices::Device&, const haptics::RunOptions&)>
      begin;
  std::function<void(const haptics::LoopRecord&, const Json& figures)> write_trace;
  double on_path = 0;  ///< as `displacement_on_path`
};

void check_call(const DeviceCall& call) {
  if (call.session.empty() && !call.trace.empty()) {
    throw InvalidInput("--record: the trace of a device is made from its session; give --session");
  }
  if (call.device == kHeldArm && call.real_time) {
    throw InvalidInput("--realtime: the simulated arm is on its own clock; use --device hand");
  }
}

/// [mm] The largest displacement of a tool that keeps to the path of a simulated hand; 0 for other
/// devices, and if it touches nothing.
double displacement_on_path(const DeviceCall& call, haptics::DeviceLoopOptions options,
                            const std::shared_ptr<const haptics::Playback>& model) {
  if (call.device != kHand && call.device != kHeldArm) return 0;
  DeviceCall rigid = call;
  rigid.device = kScripted;
  rigid.settings.clear();
  rigid.real_time = false;
  options.coupling = {.on = false};
  const OpenedDevice device = open_device(rigid, options);
  const double duration =
      call.duration > 0 ? std::min(call.duration, device.duration) : device.duration;
  haptics::DeviceRun run(*device.arm, model, options, {.duration = duration, .real_time = false});
  return run.finish().largest_displacement;
}

void run_loop(const Settings& settings, const DeviceCall& call,
              const haptics::DeviceLoopOptions& options, const PlayedLoop& played) {
  const OpenedDevice device = open_device(call, options);
  haptics::RunOptions run_options{.duration = call.duration > 0 ? call.duration : device.duration,
                                  .real_time = call.real_time,
                                  .record = call.session,
                                  .session = played.session};
  if (!call.exchange.empty()) {
    run_options.exchanges.push_back({call.exchange_at, playback_of(call.exchange, call.playback)});
  }
  const std::unique_ptr<haptics::DeviceRun> run = played.begin(*device.arm, run_options);
  const AtInterrupt at_interrupt([&run] { run->stop(); });
  const haptics::RunReport report = run->finish();
  Json figures = figures_of(call, report);
  if (played.on_path > 0) figures["displacement_on_path"] = played.on_path;
  if (!call.trace.empty()) played.write_trace(haptics::read_loop_record(call.session), figures);
  warn_of_run(call, report, device.arm->description());
  if (!report.device_lost.empty()) {
    throw DeviceError(fmt::format("{}: the device is lost after {} ticks: {}", call.device,
                                  report.time.ticks, report.device_lost));
  }
  print(settings, figures, prose_of(call, report, played.on_path));
}

}  // namespace

void play_device(const Settings& settings, const DeviceCall& call) {
  check_outputs({call.trajectory, call.model, call.pose, call.exchange},
                {call.trace, call.session});
  check_call(call);
  const haptics::Model model = playable_model(call.model);
  haptics::DeviceLoopOptions options = loop_options(call);
  if (call.pose.empty() && call.device == kHeldArm)
    options.T_world_device = probing::mount_over(model.surface, probing::ArmGeometry{});
  const auto playback = made_playback(call.model, model, call.playback);
  run_loop(settings, call, options,
           {.session = session_of(call),
            .begin =
                [&](devices::Device& arm, const haptics::RunOptions& run) {
                  return std::make_unique<haptics::DeviceRun>(arm, playback, options, run);
                },
            .write_trace =
                [&](const haptics::LoopRecord& record, const Json& /*figures*/) {
                  haptics::write_trace(call.trace, haptics::trace_of(record));
                },
            .on_path = displacement_on_path(call, options, playback)});
}

void play_scene_device(const Settings& settings, DeviceCall call) {
  const SceneOfDevice scene = read_scene_of_device(call.model, call.tool);
  std::vector<fs::path> inputs = scene.inputs;
  inputs.push_back(call.pose);
  check_outputs(inputs, {call.session});
  if (!call.trace.empty()) check_output_folder(inputs, call.trace);
  check_call(call);
  if (call.device == kHeldArm && call.pose.empty()) {
    throw InvalidInput("--device arm: in a scene it needs --pose, where its base stands");
  }
  if (!is_driver(call.device)) {
    call.trajectory = scene.file.trajectories[scene.tool];
    call.begin = haptics::input_at(scene.file.motion, 0).time;
    if (call.duration == 0) {
      call.duration =
          static_cast<double>(haptics::tick_count(scene.file.motion)) / scene.file.motion.rate;
    }
    if (call.trajectory.empty()) {
      throw InvalidInput(
          fmt::format("--device {}: tool '{}' has no trajectory in {}; a simulated "
                      "device follows the one of its tool",
                      call.device, scene.file.tools[scene.tool], call.model.string()));
    }
  }
  const haptics::DeviceLoopOptions options = loop_options(call);
  run_loop(settings, call, options,
           {.session = session_of(scene),
            .begin =
                [&](devices::Device& arm, const haptics::RunOptions& run) {
                  const std::shared_ptr<haptics::SceneWorld> world =
                      world_of(scene, arm.description().period);
                  tell_unknown_friction(scene.file, world->scene());
                  return std::make_unique<haptics::DeviceRun>(arm, world, options, run);
                },
            .write_trace =
                [&](const haptics::LoopRecord& record, const Json& figures) {
                  const std::shared_ptr<haptics::SceneWorld> world =
                      world_of(scene, record.device.period);
                  write_scene_traces(call.trace, scene.file, world->scene(),
                                     haptics::trace_of(record, *world), figures);
                }});
}

void play_replay(const Settings& settings, const fs::path& model, const fs::path& exchange,
                 const fs::path& session) {
  const haptics::LoopRecord record = haptics::read_loop_record(session);
  const Json text = Json::parse(record.session, nullptr, false);
  if (text.is_object() && text.contains("scene")) {
    throw InvalidInput(fmt::format("{}: is the session of a scene; give its file in place of {}",
                                   session.string(), model.string()));
  }
  std::vector<fs::path> folders = {model};
  if (!exchange.empty()) folders.push_back(exchange);
  const Json models = text.is_object() ? text.value("models", Json()) : Json();
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const bool known = models.is_array() && i < models.size() && models[i].is_object();
    if (known && models[i].value("fingerprint", "") != print_of_model(folders[i])) {
      throw InvalidInput(fmt::format("{}: is not the model of the session, which was {}",
                                     folders[i].string(), models[i].value("path", "another one")));
    }
  }
  const haptics::PlaybackOptions playback = models_of(record.session).playback;
  std::vector<std::shared_ptr<const haptics::Playback>> playbacks;
  std::vector<const haptics::Playback*> pointers;
  for (const fs::path& folder : folders) {
    playbacks.push_back(playback_of(folder, playback));
    pointers.push_back(playbacks.back().get());
  }
  report_replay(settings, session, haptics::replay(record, pointers));
}

void play_scene_replay(const Settings& settings, const fs::path& path, const fs::path& session) {
  const haptics::LoopRecord record = haptics::read_loop_record(session);
  const Json text = Json::parse(record.session, nullptr, false);
  const bool of_scene = text.is_object() && text.contains("scene") && text["scene"].is_array();
  if (!of_scene) {
    throw InvalidInput(fmt::format("{}: is not a session of a scene; give its model in place of {}",
                                   session.string(), path.string()));
  }
  const SceneOfDevice scene = read_scene_of_device(path, text.value("tool", ""));
  const Json then = text["scene"], now = prints_of(scene);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const bool known = i < then.size() && then[i].is_object();
    if (known && then[i].value("fingerprint", "") == now[i].at("fingerprint")) continue;
    throw InvalidInput(fmt::format(
        "{}: is not what it was in the session{}", now[i].at("path").get<std::string>(),
        known ? ", where it was " + then[i].value("path", "another file") : std::string()));
  }
  report_replay(settings, session, haptics::replay(record, *world_of(scene, record.device.period)));
}

}  // namespace palpate::apps
