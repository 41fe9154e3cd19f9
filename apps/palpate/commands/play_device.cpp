// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/play_device.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "commands/pose_file.h"
#include "palpate/error.h"
#include "palpate/haptics/device_run.h"
#include "palpate/haptics/device_stability.h"
#include "palpate/haptics/held_arm.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playable.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/haptics/trajectory_device.h"
#include "palpate/haptics/trajectory_file.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/plugin_arm.h"
#include "palpate/probing/remote_arm.h"
#include "shared/fingerprint.h"
#include "shared/inputs.h"
#include "shared/interrupts.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using PlayJson = nlohmann::ordered_json;
using DeviceSettings = std::map<std::string, std::string>;

constexpr const char* kRecorded = "recorded";
constexpr const char* kScripted = "scripted";
constexpr const char* kHand = "hand";
constexpr const char* kHeldArm = "arm";

bool is_driver(const std::string& device) {
  return device != kRecorded && device != kScripted && device != kHand && device != kHeldArm;
}

DeviceSettings settings_of(const DeviceCall& call) {
  DeviceSettings settings;
  for (const std::string& word : call.settings) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InvalidInput("--set " + word + ": must be KEY=VALUE, such as damping=0.002");
    }
    settings[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return settings;
}

double number_of(const std::string& key, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw InvalidInput("--set " + key + "=" + text + ": must be a finite number");
  }
  return value;
}

/// The options of the simulated devices.
haptics::HandOptions hand_options(const DeviceCall& call) {
  haptics::HandOptions hand;
  hand.real_time = call.real_time;
  for (const auto& [key, text] : settings_of(call)) {
    const double value = number_of(key, text);
    if (key == "mass") {
      hand.mass = value;
    } else if (key == "damping") {
      hand.damping = value;
    } else if (key == "stiffness") {
      hand.stiffness = value;
    } else if (key == "encoder_step") {
      hand.encoder_step = value;
    } else if (key == "delay") {
      hand.delay = static_cast<int>(std::clamp(value, -1.0, 1e3));
    } else if (key == "rate") {
      hand.period = 1 / value;
    } else {
      throw InvalidInput("--set " + key +
                         ": the simulated devices have mass [kg], damping [N s/mm], stiffness "
                         "[N/mm], encoder_step [mm], delay [ticks] and rate [Hz]");
    }
  }
  return hand;
}

haptics::CouplingOptions coupling_of(const std::string& word) {
  haptics::CouplingOptions coupling;
  if (word == "auto") return coupling;
  if (word == "off") {
    coupling.on = false;
    return coupling;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value > 0)) {
    throw InvalidInput("--coupling: is " + word +
                       "; it must be auto, off, or a stiffness > 0 N/mm");
  }
  coupling.stiffness = value;
  return coupling;
}

haptics::DeviceLoopOptions loop_options(const DeviceCall& call, const haptics::Model& model) {
  haptics::DeviceLoopOptions options;
  if (!call.pose.empty()) {
    options.T_world_device = read_pose(call.pose);
  } else if (call.device == kHeldArm) {
    options.T_world_device = probing::mount_over(model.surface, probing::ArmGeometry{});
  }
  options.scale = call.scale;
  for (const unsigned button : call.clutch_buttons) options.clutch_buttons |= 1U << button;
  options.safety.force = call.force;
  options.safety.slew = call.slew;
  options.safety.ramp = call.ramp;
  options.coupling = coupling_of(call.coupling);
  return options;
}

/// The trajectory as a path of the device: it is given in the object's frame.
haptics::TimedPath path_of(const DeviceCall& call, const haptics::DeviceLoopOptions& options,
                           haptics::PathShape shape) {
  if (call.trajectory.empty()) {
    throw InvalidInput("--device " + call.device +
                       ": needs --trajectory, where the device or its hand shall go");
  }
  std::vector<haptics::TrajectoryPoint> points = haptics::read_trajectory_file(call.trajectory);
  const Eigen::Isometry3d T_device_world = options.T_world_device.inverse();
  const double scale = options.scale.value_or(1);
  for (haptics::TrajectoryPoint& point : points) point.tool = T_device_world * point.tool / scale;
  return haptics::TimedPath(std::move(points), shape);
}

struct OpenDevice {
  std::unique_ptr<probing::Arm> arm;
  double duration = 0;  // [s] of its path; 0: without end
};

OpenDevice open_driver(const DeviceCall& call) {
  if (!call.trajectory.empty()) {
    throw InvalidInput("--trajectory: is for simulated devices; --device is " + call.device);
  }
  if (!fs::is_regular_file(call.device)) {
    throw FileError("--device " + call.device +
                    ": there is no such file; it must be recorded, scripted, hand, arm, or the "
                    "driver of a device, a shared library");
  }
  const fs::path library = fs::absolute(call.device);
  const DeviceSettings settings = settings_of(call);
  if (call.in_process) {
    return {std::make_unique<probing::PluginArm>(library, settings, call.number)};
  }
  return {std::make_unique<probing::RemoteArm>(
      library, probing::RemoteArmOptions{
                   .driver = settings, .number = call.number, .real_time = call.real_time})};
}

OpenDevice open_device(const DeviceCall& call, const haptics::DeviceLoopOptions& options) {
  if (is_driver(call.device)) return open_driver(call);
  const haptics::HandOptions hand = hand_options(call);
  const bool recorded = call.device == kRecorded;
  haptics::TimedPath path =
      path_of(call, options, recorded ? haptics::PathShape::linear : haptics::PathShape::smooth);
  const double duration = std::max(path.duration(), hand.period);
  if (call.device == kHand) {
    return {std::make_unique<haptics::SimulatedHand>(std::move(path), hand), duration};
  }
  if (call.device == kHeldArm) {
    return {std::make_unique<haptics::HeldArm>(std::move(path), hand), duration};
  }
  return {std::make_unique<haptics::TrajectoryDevice>(
              std::move(path),
              haptics::TrajectoryDeviceOptions{.period = hand.period, .real_time = call.real_time}),
          duration};
}

/// What tells a model from another one, for sessions.
std::string print_of_model(const fs::path& folder) {
  const fs::path json = folder / "field.json";
  return fingerprint(is_there(json) ? json : folder / "field.cbor") +
         fingerprint(folder / "surface.ply");
}

std::string session_text(const DeviceCall& call) {
  PlayJson models = PlayJson::array();
  for (const fs::path& model : {call.model, call.exchange}) {
    if (!model.empty()) {
      models.push_back({{"path", model.string()}, {"fingerprint", print_of_model(model)}});
    }
  }
  // A path need not be Unicode.
  return PlayJson{{"models", models}}.dump(-1, ' ', false, PlayJson::error_handler_t::replace);
}

/// \throws InvalidInput naming the folder if the model cannot be felt with a device.
haptics::Model playable_model(const fs::path& folder) {
  haptics::Model model = haptics::read_model(folder);
  try {
    haptics::check_playable(model);
  } catch (const InvalidInput& wrong) {
    throw InvalidInput(folder.string() + ": " + wrong.what());
  }
  return model;
}

std::shared_ptr<const haptics::Playback> playback_of(const fs::path& folder) {
  return std::make_shared<const haptics::Playback>(playable_model(folder));
}

constexpr std::array<const char*, 9> kActions = {
    "ramped", "clamped", "slewed",    "force_not_finite", "state_not_finite",
    "stale",  "late",    "no_answer", "disarmed"};

PlayJson figures_of(const DeviceCall& call, const haptics::RunReport& report) {
  PlayJson safety;
  for (std::size_t i = 0; i < kActions.size(); ++i) safety[kActions[i]] = report.actions[i];
  const bool coupled = std::isfinite(report.coupling_stiffness);
  return {{"device", call.device},
          {"steps", report.time.ticks},
          {"free", report.states[0]},
          {"stick", report.states[1]},
          {"slip", report.states[2]},
          {"largest_force", report.largest_force},
          {"rate", report.time.rate},
          {"late", report.time.late},
          {"us_per_step",
           {{"p50", report.time.p50}, {"p999", report.time.p999}, {"max", report.time.largest}}},
          {"real_time", call.real_time && report.not_real_time.empty()},
          {"memory_locked", report.memory_locked},
          {"coupling_stiffness",
           number_or_null(coupled ? std::optional(report.coupling_stiffness) : std::nullopt)},
          {"given_energy", report.given.in_touches},
          {"touches", report.given.touches},
          {"giving_touches", report.given.giving},
          {"exchanges", report.exchanges},
          {"safety", safety}};
}

std::string prose_of(const DeviceCall& call, const haptics::RunReport& report) {
  std::string safety;
  for (std::size_t i = 0; i < kActions.size(); ++i) {
    if (report.actions[i] == 0) continue;
    std::string word = kActions[i];
    std::ranges::replace(word, '_', ' ');
    safety += fmt::format("{}{} {}", safety.empty() ? "" : ", ", word, report.actions[i]);
  }
  return fmt::format(
      "{} ticks at {:.0f} Hz: {} free, {} stick, {} slip; largest force {:.3f} N; {} late\n"
      "A tick takes {:.1f} us (median), {:.1f} us (99.9 %), at most {:.1f} us\n"
      "{}; the user was given {:.3f} N mm in {} of {} touches\n"
      "Safety, in ticks: {}{}{}",
      report.time.ticks, report.time.rate, report.states[0], report.states[1], report.states[2],
      report.largest_force, report.time.late, report.time.p50, report.time.p999,
      report.time.largest,
      std::isfinite(report.coupling_stiffness)
          ? fmt::format("Virtual coupling of {:.3g} N/mm", report.coupling_stiffness)
          : std::string("No virtual coupling"),
      report.given.in_touches, report.given.giving, report.given.touches,
      safety.empty() ? "nothing" : safety,
      report.exchanges > 0 ? fmt::format("\n{} exchange of the model", report.exchanges) : "",
      call.session.empty() ? "" : "\nRecorded in " + call.session.string());
}

void warn(const DeviceCall& call, const haptics::RunReport& report,
          const probing::ArmDescription& device) {
  if (!report.not_real_time.empty()) {
    spdlog::warn(
        "no real-time scheduling (SCHED_FIFO): {}; the loop runs with ordinary priority and may be "
        "late. Allow it with a limit 'rtprio' in /etc/security/limits.conf.",
        report.not_real_time);
  }
  if (call.coupling == "auto" && device.damping == 0 && is_driver(call.device)) {
    spdlog::warn(
        "{} does not declare its damping: that of a light grip, 5e-4 N s/mm, is assumed for the "
        "virtual coupling.",
        call.device);
  }
  if (report.refused > 0) spdlog::warn("{} commands were not taken.", report.refused);
}

/// Runs until the end, Ctrl-C, or the device is lost; exchanges the model on the way.
haptics::RunReport finish(haptics::DeviceRun& run, const DeviceCall& call) {
  const AtInterrupt at_interrupt([&run] { run.stop(); });
  if (call.real_time && !call.exchange.empty()) {
    const auto end =
        std::chrono::steady_clock::now() + std::chrono::duration<double>(call.exchange_at);
    constexpr std::chrono::milliseconds kPause(1);
    while (!run.done() && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(kPause);
    }
    if (!run.done()) run.exchange(playback_of(call.exchange));
  }
  return run.finish();
}

}  // namespace

void play_device(const Settings& settings, const DeviceCall& call) {
  check_outputs({call.trajectory, call.model, call.pose, call.exchange},
                {call.trace, call.session});
  if (call.session.empty() && !call.trace.empty()) {
    throw InvalidInput("--record: the trace of a device is made from its session; give --session");
  }
  if (call.device == kHeldArm && call.real_time) {
    throw InvalidInput("--realtime: the simulated arm is on its own clock; use --device hand");
  }
  const haptics::Model model = playable_model(call.model);
  const haptics::DeviceLoopOptions options = loop_options(call, model);
  const OpenDevice device = open_device(call, options);
  haptics::RunOptions run_options{.duration = call.duration > 0 ? call.duration : device.duration,
                                  .real_time = call.real_time,
                                  .record = call.session,
                                  .session = session_text(call)};
  if (!call.real_time && !call.exchange.empty()) {
    run_options.exchanges.push_back({call.exchange_at, playback_of(call.exchange)});
  }
  haptics::DeviceRun run(*device.arm, std::make_shared<const haptics::Playback>(model), options,
                         run_options);
  const haptics::RunReport report = finish(run, call);
  if (!call.trace.empty()) {
    haptics::write_trace(call.trace, haptics::trace_of(haptics::read_loop_record(call.session)));
  }
  warn(call, report, device.arm->description());
  if (!report.device_lost.empty()) {
    throw DeviceError(fmt::format("{}: the device does not answer any more after {} ticks: {}",
                                  call.device, report.time.ticks, report.device_lost));
  }
  print(settings, figures_of(call, report), prose_of(call, report));
}

void play_replay(const Settings& settings, const fs::path& model, const fs::path& exchange,
                 const fs::path& session) {
  const haptics::LoopRecord record = haptics::read_loop_record(session);
  const PlayJson text = PlayJson::parse(record.session, nullptr, false);
  std::vector<fs::path> folders = {model};
  if (!exchange.empty()) folders.push_back(exchange);
  const PlayJson models = text.is_object() ? text.value("models", PlayJson()) : PlayJson();
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const bool known = models.is_array() && i < models.size() && models[i].is_object();
    if (known && models[i].value("fingerprint", "") != print_of_model(folders[i])) {
      throw InvalidInput(fmt::format("{}: is not the model of the session, which was {}",
                                     folders[i].string(), models[i].value("path", "another one")));
    }
  }
  std::vector<std::shared_ptr<const haptics::Playback>> playbacks;
  std::vector<const haptics::Playback*> pointers;
  for (const fs::path& folder : folders) {
    playbacks.push_back(playback_of(folder));
    pointers.push_back(playbacks.back().get());
  }
  const haptics::LoopReplay again = haptics::replay(record, pointers);
  if (again.different > 0) {
    throw Error(
        fmt::format("{}: the replay differs in {} of {} ticks, first in tick {}: another version "
                    "of the program "
                    "computed the session",
                    session.string(), again.different, again.ticks, again.first_different));
  }
  print(settings, {{"replayed", again.ticks}, {"different", again.different}},
        fmt::format("{} ticks replayed; every command and contact is the same to the bit",
                    again.ticks));
}

void play_stability(const Settings& settings, const DeviceCall& call) {
  const haptics::Model model = haptics::read_model(call.model);
  const haptics::ModelStiffness stiffness = haptics::model_stiffness(model, call.force);
  haptics::HandOptions hand;
  double scale = call.scale.value_or(1);
  if (is_driver(call.device)) {
    const OpenDevice device = open_driver(call);
    const probing::ArmDescription& description = device.arm->description();
    hand.period = description.period;
    hand.damping = description.damping;
    constexpr double kRounding = 1e-9;  // [ticks] of a delay of whole ticks
    hand.delay = static_cast<int>(std::ceil(description.delay / description.period - kRounding));
    scale = call.scale.value_or(description.workspace_scale);
  } else {
    hand = hand_options(call);
    hand.real_time = false;
  }
  const haptics::CouplingOptions coupling = coupling_of(call.coupling);
  const double delay = hand.delay * hand.period;
  const double passive = haptics::passive_stiffness(hand.damping, hand.period, delay);
  const double spring = haptics::coupling_stiffness(coupling, hand.damping, hand.period, delay);
  const auto felt = [&](double object) { return object * spring / (object + spring); };
  haptics::CouplingOptions off = coupling;
  off.on = false;
  const double calm_without = haptics::largest_calm_stiffness(hand, off);
  const double calm_with =
      coupling.on ? haptics::largest_calm_stiffness(hand, coupling) : calm_without;
  const double median = stiffness.median * scale, largest = stiffness.largest * scale;

  PlayJson needs = PlayJson::array();
  std::string table;
  for (const double rate : {500.0, 1000.0, 2000.0, 4000.0}) {
    const double period = 1 / rate;
    const double for_median = haptics::passive_damping(median, period, hand.delay * period);
    const double for_largest = haptics::passive_damping(largest, period, hand.delay * period);
    needs.push_back(
        {{"rate", rate}, {"damping_of_median", for_median}, {"damping_of_largest", for_largest}});
    table += fmt::format("\n  {:6.0f} Hz   {:10.4g}   {:10.4g}", rate, for_median, for_largest);
  }
  const auto calm_words = [](double value) {
    return value >= 1e3 ? std::string("any stiffness up to 1000 N/mm")
                        : fmt::format("up to {:.3g} N/mm", value);
  };
  print(settings,
        {{"median_stiffness", median},
         {"largest_stiffness", largest},
         {"stiffest_contact", stiffness.stiffest},
         {"damping", hand.damping},
         {"delay", delay},
         {"rate", 1 / hand.period},
         {"passive_stiffness", passive},
         {"coupling_stiffness", number_or_null(coupling.on ? std::optional(spring) : std::nullopt)},
         {"felt_stiffness", coupling.on ? felt(largest) : largest},
         {"calm_without_coupling", calm_without},
         {"calm_with_coupling", calm_with},
         {"needed_damping", needs}},
        fmt::format(
            "At the device the model has {:.3g} N/mm in the median, at most {:.3g} N/mm (contact "
            "{})\n"
            "The device: damping {:.3g} N s/mm, {:.0f} Hz, delay {:.3g} ms; passive up to {:.3g} "
            "N/mm\n"
            "Pressed by a simulated hand of {:.3g} kg it is calm on {} without a virtual coupling, "
            "on {} with one\n"
            "{}\n"
            "Damping [N s/mm] that a device needs without a coupling, with a delay of {} ticks:\n"
            "       rate       median      largest{}",
            median, largest, stiffness.stiffest, hand.damping, 1 / hand.period, 1e3 * delay,
            passive, hand.mass, calm_words(calm_without), calm_words(calm_with),
            coupling.on ? fmt::format("The coupling has {:.3g} N/mm: the user feels {:.3g} N/mm in "
                                      "the median, at most {:.3g} N/mm",
                                      spring, felt(median), felt(largest))
                        : std::string("The coupling is off"),
            hand.delay, table));
}

}  // namespace palpate::apps
