// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "models/play_device.h"
#include "models/play_scene.h"
#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/tool_radius.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/haptics/trajectory_file.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/model_pictures.h"
#include "shared/output_checks.h"
#include "shared/played_model.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// The ways to call `palpate play`, one bit each.
enum PlayWay : unsigned {
  kAlong = 1,          ///< forces along a trajectory, without a device
  kWithSimulated = 2,  ///< the loop with a simulated device
  kWithDriver = 4,     ///< the loop with a device behind a driver
  kReplaying = 8,
  kStabilityOfHand = 16,
  kStabilityOfDriver = 32,
  kScene = 64,  ///< a scene file along the ways that it names
  kSceneSimulated = 128,
  kSceneDriver = 256,
  kSceneReplay = 512
};

constexpr unsigned kSceneDevice = kSceneSimulated | kSceneDriver;
constexpr unsigned kModelDevice = kWithSimulated | kWithDriver;
constexpr unsigned kAnyDevice = kModelDevice | kSceneDevice;
constexpr unsigned kAnyDriver = kWithDriver | kSceneDriver;
constexpr unsigned kAnyStability = kStabilityOfHand | kStabilityOfDriver;

struct PlayOption {
  const char* name;
  unsigned ways;  // in which the option has an effect
  const char* needs;
};

// Every option of the command except those that all commands have, and most of lists.
constexpr PlayOption kPlayOptions[] = {
    {"--trajectory", kAlong | kWithSimulated, "a model folder, alone or with a simulated --device"},
    {"--record", kAlong | kAnyDevice | kScene, "--trajectory, --device or a scene file"},
    {"--picture", kAlong, "--trajectory without --device"},
    {"--tool-radius", kAlong, "--trajectory without --device"},
    {"--probe-radius", kAlong, "--trajectory without --device"},
    {"--device", kAnyDevice | kAnyStability, "no --replay"},
    {"--tool", kSceneDevice, "a scene file and --device"},
    {"--set", kAnyDevice | kAnyStability, "--device or --stability"},
    {"--device-number", kAnyDriver | kStabilityOfDriver, "the driver of a device as --device"},
    {"--in-process", kAnyDriver | kStabilityOfDriver, "the driver of a device as --device"},
    {"--realtime", kAnyDevice, "--device"},
    {"--duration", kAnyDevice, "--device"},
    {"--session", kAnyDevice, "--device"},
    {"--replay", kReplaying | kSceneReplay, "no --device"},
    {"--pose", kAnyDevice, "--device"},
    {"--scale", kAnyDevice | kAnyStability, "--device or --stability"},
    {"--max-force", kAnyDevice | kAnyStability, "--device or --stability"},
    {"--clutch-button", kAnyDriver, "the driver of a device as --device"},
    {"--exchange", kModelDevice | kReplaying, "--device or --replay, with a model folder"},
    {"--exchange-at", kModelDevice, "--device, with a model folder"},
    {"--stability", kAnyStability, "a model folder, and no --replay"},
};

const char* words_of_way(PlayWay way) {
  switch (way) {
    case kAlong:
      return "without --device";
    case kWithSimulated:
      return "with a simulated device";
    case kWithDriver:
      return "with the driver of a device";
    case kReplaying:
      return "with --replay";
    case kStabilityOfHand:
      return "with --stability of the simulated hand";
    case kStabilityOfDriver:
      return "with --stability";
    case kScene:
      return "with a scene file, which says where its tools go";
    case kSceneSimulated:
    case kSceneDriver:
      return "with a device in a scene";
    case kSceneReplay:
      return "with --replay of a scene";
  }
  return "";
}

/// \throws InvalidInput naming the first option that is given but has no effect in this way, and
/// what it needs.
void refuse_idle_options(const CLI::App& play, PlayWay way) {
  const auto refuse_idle = [&](const std::string& name, unsigned ways, const char* needs) {
    const bool works = (ways & way) != 0;
    if (works || play.get_option(name)->count() == 0) return;
    throw InvalidInput(name + ": does nothing " + words_of_way(way) + "; it needs " + needs);
  };
  for (const PlayOption& option : kPlayOptions) refuse_idle(option.name, option.ways, option.needs);
  const auto refuse_fields = [&](const FieldList& fields, unsigned ways, const char* needs) {
    for (const FieldText& field : texts_of(fields)) {
      if (field.name != "max_force")  // --stability has it, too
        refuse_idle(field_option(field.type + "::" + field.name), ways, needs);
    }
  };
  DeviceCall usual;
  refuse_fields(fields_of(usual.safety), kAnyDevice, "--device");
  refuse_fields(fields_of(usual.coupling), kAnyDevice | kAnyStability, "--device or --stability");
  refuse_fields(fields_of(usual.playback), kAlong | kModelDevice,
                "a model folder with --trajectory or --device; a scene file has \"playback\" for "
                "each object");
}

struct PlayCall {
  fs::path model, trajectory, record, picture, replay;
  bool stability = false;
  std::optional<double> tool_radius, probe_radius;  ///< [mm]
  DeviceCall device;
};

/// [mm] Radius of the ball that probed, from the model or the call; none: not known.
std::optional<double> probe_radius_of(const PlayCall& call, const haptics::Model& model) {
  if (!call.probe_radius) return model.probe_radius;
  if (model.probe_radius && *model.probe_radius != *call.probe_radius) {
    throw InvalidInput(fmt::format("--probe-radius: is {:g} mm; {} says {:g} mm",
                                   *call.probe_radius, call.model.string(), *model.probe_radius));
  }
  return call.probe_radius;
}

/// Warns that the tool is not the ball that probed. \param largest_force [N] that was played.
void warn_of_radius(const PlayCall& call, const std::optional<double>& probe_radius,
                    double largest_force) {
  if (!call.tool_radius) return;
  if (!probe_radius) {
    spdlog::warn(
        "how wrong the forces on a ball of {:g} mm are is not known: {} does not say with which "
        "ball it was measured; give --probe-radius.",
        *call.tool_radius, call.model.string());
    return;
  }
  if (*call.tool_radius == *probe_radius) return;
  const double missing = haptics::missing_force(*probe_radius, *call.tool_radius);
  spdlog::warn(
      "the model was measured with a ball of {:g} mm; on a solid, one of {:g} mm feels {:.0f} % "
      "{} force (Hertz), here up to {} of {}; on a thin membrane about the same "
      "(docs/trade-playback.md).",
      *probe_radius, *call.tool_radius, 100 * std::abs(missing), missing > 0 ? "more" : "less",
      newtons(std::abs(missing) * largest_force, 3), newtons(largest_force, 3));
}

void play(const Settings& settings, const PlayCall& call) {
  check_outputs({call.trajectory, call.model}, {call.record, call.picture});
  check_pictures({call.picture});
  const std::vector<haptics::TrajectoryPoint> trajectory =
      haptics::read_trajectory_file(call.trajectory);
  const haptics::Model model = playable_model(call.model);
  const std::optional<double> probe_radius = probe_radius_of(call, model);
  const std::shared_ptr<const haptics::Playback> playback_there =
      made_playback(call.model, model, call.device.playback);
  const haptics::Playback& playback = *playback_there;
  const std::vector<haptics::TracePoint> trace = haptics::play(playback, trajectory);
  if (!call.record.empty()) haptics::write_trace(call.record, trace);
  if (!call.picture.empty()) {
    draw_trace(call.picture, trace, "Forces along " + call.trajectory.filename().string());
  }

  double largest = 0;
  for (const haptics::TracePoint& point : trace) largest = std::max(largest, point.force.norm());
  const StepTimes times = time_steps(playback, trajectory);
  print(settings,
        {{"steps", trace.size()},
         {"free", times.free.count},
         {"stick", times.stick.count},
         {"slip", times.slip.count},
         {"largest_force", largest},
         {"unknown_friction", playback.unknown_friction_count()},
         {"us_per_step",
          {{"median", times.all.median},
           {"p90", times.all.p90},
           {"max", times.all.max},
           {"slip_median", times.slip.median}}}},
        fmt::format("{} steps: {} free, {} stick, {} slip; largest force {}\n"
                    "A step of the loop takes {:.1f} us (median), 90 % within {:.1f} us, at most "
                    "{:.1f} us; {}.{}",
                    trace.size(), times.free.count, times.stick.count, times.slip.count,
                    newtons(largest, 3), times.all.median, times.all.p90, times.all.max,
                    times.slip.count > 0
                        ? fmt::format("a slipping step {:.1f} us (median)", times.slip.median)
                        : "no step slipped",
                    call.record.empty() ? "" : "\nWritten to " + call.record.string()));
  if (times.stick.count + times.slip.count == 0) {
    spdlog::warn(
        "the tool never touches the model: the trajectory must cross its surface from outside, in "
        "the same frame and in mm.");
  }
  warn_of_radius(call, probe_radius, largest);
}

/// A scene is a file, a model a folder.
bool is_scene(const fs::path& path) {
  std::error_code not_there;  // its reader reports this
  return path.extension() == ".json" || fs::is_regular_file(path, not_there);
}

PlayWay way_of(const PlayCall& call) {
  const bool scene = is_scene(call.model);
  if (!call.replay.empty()) return scene ? kSceneReplay : kReplaying;
  if (call.device.device.empty()) return scene ? kScene : kAlong;
  const bool driver = is_driver(call.device.device);
  if (scene) return driver ? kSceneDriver : kSceneSimulated;
  if (call.stability) return driver ? kStabilityOfDriver : kStabilityOfHand;
  return driver ? kWithDriver : kWithSimulated;
}

/// Does what the call requests: plays a scene, a trajectory, a device, or a session again, or
/// computes the stability of a device.
void play_anything(const Settings& settings, const CLI::App& command, PlayCall& call) {
  DeviceCall& device = call.device;
  device.model = call.model;
  device.trajectory = call.trajectory;
  device.trace = call.record;
  if (device.device.empty() && call.stability) device.device = kHand;
  if (!device.device.empty() && is_driver(device.device)) check_driver(device.device);
  const PlayWay way = way_of(call);
  refuse_idle_options(command, way);
  switch (way) {
    case kAlong:
      if (call.trajectory.empty()) {
        throw InvalidInput("palpate play: needs --trajectory, --device, --replay or --stability");
      }
      return play(settings, call);
    case kScene:
      return play_scene(settings, call.model, call.record);
    case kWithSimulated:
    case kWithDriver:
      return play_device(settings, device);
    case kSceneSimulated:
    case kSceneDriver:
      return play_scene_device(settings, device);
    case kSceneReplay:
      return play_scene_replay(settings, call.model, call.replay);
    case kReplaying:
      return play_replay(settings, call.model, device.exchange, call.replay);
    case kStabilityOfHand:
    case kStabilityOfDriver:
      return play_stability(settings, device);
  }
}

void add_device_options(CLI::App& command, PlayCall& call) {
  DeviceCall& device = call.device;
  command.add_option("--device", device.device,
                     "Close the loop with a device: recorded or scripted (follow --trajectory, "
                     "exactly or smoothly from point to point), hand (simulated), arm (simulated, "
                     "held by the hand), or a driver, a shared library (docs/devices.md)");
  command.add_option("--tool", device.tool,
                     "Name of the tool of a scene that the device moves (default: the first)");
  command.add_option(
      "--set", device.settings,
      "Options of the device, KEY=VALUE; of the simulated hand " + hand_settings_in_words());
  command.add_option("--device-number", device.number, "Which of a driver's devices, from 0");
  command.add_flag("--in-process", device.in_process,
                   "Run the driver in this process: faster, but if it crashes, so does the loop");
  command.add_flag("--realtime", device.real_time,
                   "On the host's clock, with real-time scheduling if that is allowed");
  add_number(command, "--duration", device.duration, above(0).finite(),
             "Duration [s] (default: that of the trajectory; with a driver, until Ctrl-C)");
  command.add_option("--session", device.session,
                     "Record to write of all that the loop reads and commands, for --replay");
  command.add_option("--replay", call.replay, "Recompute a session and check that it is identical");
  command.add_option("--pose", device.pose,
                     "Pose of the device's frame in the model's: a file with a 3 x 4 matrix");
  add_number(command, "--scale", device.scale, above(0).finite(),
             "Length in the model per length at the device [mm/mm] (default: as the device "
             "declares, or 1)");
  add_number(command, "--clutch-button", device.clutch_buttons, at_least(0).at_most(31),
             "Buttons (numbers from 0) that hold the tool still while they are pressed");
  add_fields(command, fields_of(device.coupling));
  add_fields(command, fields_of(device.safety));
  command.add_option("--exchange", device.exchange,
                     "Another model, which replaces the first after the time --exchange-at");
  add_number(command, "--exchange-at", device.exchange_at, at_least(0).finite(),
             "Time after which --exchange replaces the model, without a pause [s]")
      ->needs("--exchange");
  command.add_flag(
      "--stability", call.stability,
      "Report which stiffness is stable with the device, and which rate and damping the "
      "model needs");
}

}  // namespace

void add_play(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<PlayCall>();
  CLI::App* command = app.add_subcommand(
      "play", "Compute the forces along a tool's path over a model, as in the haptic loop");
  add_required(*command, "MODEL", call->model,
               "Model folder; or a scene file (JSON or YAML) of several objects and tools "
               "(docs/devices.md)");
  command->add_option(
      "--trajectory", call->trajectory,
      "Tool positions, one per step: t,x,y,z [s, mm], CSV or binary; with --device, "
      "where a simulated device or its hand goes");
  command->add_option(
      "--record", call->record,
      "Trace to write: t,x,y,z,cx,cy,cz,fx,fy,fz,state (f: force that the user feels); of "
      "a scene, a folder with the traces of its tools and objects");
  command->add_option("--picture", call->picture, "Also draw the forces over time (PNG)");
  add_fields(*command, fields_of(call->device.playback));
  CLI::Option* tool_radius =
      add_number(*command, "--tool-radius", call->tool_radius, above(0).finite(),
                 "Radius of the tool, a ball [mm]. If the object was measured with another radius, "
                 "the command says how large the errors of the forces are");
  add_number(
      *command, "--probe-radius", call->probe_radius, above(0).finite(),
      "Radius of the ball with which the object was measured [mm], if the model does not say "
      "it")
      ->needs(tool_radius);
  add_device_options(*command, *call);
  command->footer(
      "Examples:\n"
      "  palpate play model/ --trajectory t.csv --record trace.csv\n"
      "  palpate play scene.json --record traces/\n"
      "  palpate play model/ --device hand --trajectory t.csv --session s.bin\n"
      "  palpate play model/ --replay s.bin\n"
      "  palpate play model/ --device ./libdevice.so --realtime\n"
      "  palpate play scene.json --device ./libdevice.so --tool left\n"
      "  palpate play model/ --stability --set damping=0.002");
  command->callback([call, command, &settings] { play_anything(settings, *command, *call); });
}

}  // namespace palpate::apps
