// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "commands/play_device.h"
#include "commands/play_scene.h"
#include "palpate/error.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/tool_radius.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/haptics/trajectory_file.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/model_pictures.h"
#include "shared/step_times.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct PlayCall {
  fs::path model, trajectory, record, picture, replay;
  bool stability = false;
  std::optional<double> tool_radius, probe_radius;  ///< [mm]
  DeviceCall device;
};

/// Warns that the tool is not the ball that probed. \param largest_force [N] that was played.
void warn_of_radius(const PlayCall& call, double largest_force) {
  if (!call.tool_radius || *call.tool_radius == *call.probe_radius) return;
  const double missing = haptics::missing_force(*call.probe_radius, *call.tool_radius);
  spdlog::warn(
      "the model was measured with a ball of {:g} mm; on a solid, one of {:g} mm feels {:.0f} % "
      "{} force (Hertz), here up to {:.3f} N of {:.3f} N; on a thin membrane about the same "
      "(docs/trade-playback.md).",
      *call.probe_radius, *call.tool_radius, 100 * std::abs(missing), missing > 0 ? "more" : "less",
      std::abs(missing) * largest_force, largest_force);
}

void play(const Settings& settings, const PlayCall& call) {
  check_outputs({call.trajectory, call.model}, {call.record, call.picture});
  check_pictures({call.picture});
  const std::vector<haptics::TrajectoryPoint> trajectory =
      haptics::read_trajectory_file(call.trajectory);
  const haptics::Playback playback(haptics::read_model(call.model));
  const std::vector<haptics::TracePoint> trace = haptics::play(playback, trajectory);
  if (!call.record.empty()) haptics::write_trace(call.record, trace);
  if (!call.picture.empty()) {
    draw_trace(call.picture, trace, "Forces along " + call.trajectory.filename().string());
  }

  double largest = 0;
  for (const haptics::TracePoint& point : trace) largest = std::max(largest, point.force.norm());
  const StepTimes times = time_steps(playback, trajectory);
  const std::optional<double> slipping =
      times.slip.count > 0 ? std::optional(times.slip.median) : std::nullopt;
  print(settings,
        {{"steps", trace.size()},
         {"free", times.free.count},
         {"stick", times.stick.count},
         {"slip", times.slip.count},
         {"largest_force", largest},
         {"us_per_step",
          {{"median", times.all.median},
           {"p90", times.all.p90},
           {"max", times.all.max},
           {"slip_median", number_or_null(slipping)}}}},
        fmt::format("{} steps: {} free, {} stick, {} slip; largest force {:.3f} N\n"
                    "A step of the loop takes {:.1f} us (median), 90 % within {:.1f} us, at most "
                    "{:.1f} us; {}.{}",
                    trace.size(), times.free.count, times.stick.count, times.slip.count, largest,
                    times.all.median, times.all.p90, times.all.max,
                    slipping ? fmt::format("a slipping step {:.1f} us (median)", *slipping)
                             : "no step slipped",
                    call.record.empty() ? "" : "\nWritten to " + call.record.string()));
  if (times.stick.count + times.slip.count == 0) {
    spdlog::warn(
        "the tool never touches the model: the trajectory must cross its surface from outside, in "
        "the same frame and in mm.");
  }
  warn_of_radius(call, largest);
}

struct GivenOption {
  const char* name;
  bool given;
};

/// \throws InvalidInput naming the first of these options that is given, which would do nothing.
void refuse_unused(std::initializer_list<GivenOption> options, const std::string& why) {
  for (const GivenOption& option : options) {
    if (option.given) throw InvalidInput(option.name + (": " + why));
  }
}

/// What is asked for: a scene, a trajectory, a device, a session again, or the stability of a
/// device.
void play_anything(const Settings& settings, PlayCall& call) {
  DeviceCall& device = call.device;
  device.model = call.model;
  device.trajectory = call.trajectory;
  device.trace = call.record;
  const bool has_device = !device.device.empty();
  if (!has_device && (device.real_time || !device.session.empty())) {
    throw InvalidInput("--realtime and --session: need --device");
  }
  if ((has_device || call.stability || !call.replay.empty()) && !call.picture.empty()) {
    throw InvalidInput("--picture: shows the forces along a trajectory; it goes without --device");
  }
  if (call.tool_radius.has_value() != call.probe_radius.has_value()) {
    throw InvalidInput("--tool-radius and --probe-radius: need each other");
  }
  const bool plays_path = call.replay.empty() && !call.stability && !has_device;
  std::error_code not_there;  // is refused where the model is read
  const bool is_scene = fs::is_regular_file(call.model, not_there);
  if (call.tool_radius && (!plays_path || is_scene)) {
    throw InvalidInput("--tool-radius: says how wrong forces along a --trajectory are");
  }
  const GivenOption pose{"--pose", !device.pose.empty()},
      scale{"--scale", device.scale.has_value()}, coupling{"--coupling", device.coupling != "auto"},
      set{"--set", !device.settings.empty()}, exchange{"--exchange", !device.exchange.empty()},
      record{"--record", !call.record.empty()};
  if (is_scene) {
    refuse_unused({pose,
                   scale,
                   coupling,
                   set,
                   exchange,
                   {"--trajectory", !call.trajectory.empty()},
                   {"--picture", !call.picture.empty()},
                   {"--device", has_device},
                   {"--replay", !call.replay.empty()},
                   {"--stability", call.stability}},
                  "has no effect with a scene file, which says where its tools go");
    play_scene(settings, call.model, call.record);
  } else if (!call.replay.empty()) {
    refuse_unused({record, pose, scale, coupling, set}, "has no effect with --replay");
    if (has_device || call.stability || !call.trajectory.empty()) {
      throw InvalidInput(
          "--replay: the session says what was read; leave out --device, --trajectory and "
          "--stability");
    }
    play_replay(settings, call.model, device.exchange, call.replay);
  } else if (call.stability) {
    refuse_unused({record, pose, exchange}, "has no effect with --stability");
    if (!has_device) device.device = "hand";
    play_stability(settings, device);
  } else if (has_device) {
    play_device(settings, device);
  } else if (call.trajectory.empty()) {
    throw InvalidInput("palpate play: needs --trajectory, --device, --replay or --stability");
  } else {
    refuse_unused({pose, scale, coupling, set, exchange}, "needs --device");
    play(settings, call);
  }
}

void add_device_options(CLI::App& command, PlayCall& call) {
  DeviceCall& device = call.device;
  command.add_option("--device", device.device,
                     "Close the loop with a device: recorded or scripted (follow --trajectory, "
                     "exactly or smoothly from point to point), hand (simulated), arm (simulated, "
                     "held by the hand), or a driver, a shared library (docs/devices.md)");
  command.add_option("--set", device.settings,
                     "Options of the device, KEY=VALUE; of simulated ones mass [kg], damping [N "
                     "s/mm], stiffness [N/mm], encoder_step [mm], delay [ticks], rate [Hz]");
  command.add_option("--device-number", device.number, "Which of a driver's devices, from 0");
  command.add_flag("--in-process", device.in_process,
                   "Run the driver in this process: faster, but its crash is that of the loop");
  command.add_flag("--realtime", device.real_time,
                   "On the host's clock, with real-time scheduling if that is allowed");
  command
      .add_option("--duration", device.duration,
                  "[s] (default: that of the trajectory; of a driver, until Ctrl-C)")
      ->check(within(above(0).finite()));
  command.add_option("--session", device.session,
                     "Record of all that the loop reads and commands, which --replay takes");
  command.add_option("--replay", call.replay, "Compute a session again and compare every bit");
  command.add_option("--pose", device.pose,
                     "Where the device's frame lies in the model's: a file with a 3 x 4 matrix");
  command
      .add_option("--scale", device.scale,
                  "[mm/mm] of the model for one of the device (default: as it declares, or 1)")
      ->check(within(above(0).finite()));
  command
      .add_option("--clutch-button", device.clutch_buttons,
                  "Numbers of buttons, from 0, while which the tool stands still")
      ->check(within(at_least(0).at_most(31)));
  command.add_option("--coupling", device.coupling,
                     "Virtual coupling: auto (by the device's damping and delay), off, or N/mm");
  command.add_option("--max-force", device.force, "[N] Longer forces are shortened")
      ->check(within(above(0).finite()));
  command.add_option("--slew", device.slew, "[N/s] by which a force may grow")
      ->check(within(above(0).finite()));
  command
      .add_option("--ramp", device.ramp, "[s] in which the force grows after a start or a fault")
      ->check(within(above(0).finite()));
  command.add_option("--exchange", device.exchange, "Another model, which replaces the first ...");
  command
      .add_option("--exchange-at", device.exchange_at, "... after this time [s], without a pause")
      ->check(within(at_least(0).finite()));
  command.add_flag("--stability", call.stability,
                   "Say which stiffness is calm with the device, and which rate and damping the "
                   "model needs");
}

}  // namespace

void add_play(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<PlayCall>();
  CLI::App* command = app.add_subcommand(
      "play", "Compute the forces along a tool's path over a model, as in the haptic loop");
  command
      ->add_option("MODEL", call->model,
                   "Model folder; or a scene file (JSON) of several objects and tools "
                   "(docs/devices.md)")
      ->required();
  command->add_option(
      "--trajectory", call->trajectory,
      "Tool positions, one per step: t,x,y,z [s, mm], CSV or binary; with --device, "
      "where a simulated device or its hand goes");
  command->add_option("--record", call->record,
                      "Trace to write: t,x,y,z,cx,cy,cz,fx,fy,fz,state (f: force on the user); of "
                      "a scene, a folder with the traces of its tools and objects");
  command->add_option("--picture", call->picture, "Also draw the forces over time (PNG)");
  command
      ->add_option("--tool-radius", call->tool_radius,
                   "[mm] of a ball; if it is not --probe-radius, say how wrong the forces are")
      ->check(within(above(0).finite()));
  command
      ->add_option("--probe-radius", call->probe_radius,
                   "[mm] of the ball with which the object was measured")
      ->check(within(above(0).finite()));
  add_device_options(*command, *call);
  command->footer(
      "Examples:\n"
      "  palpate play model/ --trajectory t.csv --record trace.csv\n"
      "  palpate play scene.json --record traces/\n"
      "  palpate play model/ --device hand --trajectory t.csv --session s.bin\n"
      "  palpate play model/ --replay s.bin\n"
      "  palpate play model/ --device ./libdevice.so --realtime\n"
      "  palpate play model/ --stability --set damping=0.002");
  command->callback([call, &settings] { play_anything(settings, *call); });
}

}  // namespace palpate::apps
