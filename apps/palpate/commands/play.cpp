// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/trajectory_csv.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/model_pictures.h"
#include "shared/step_times.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct PlayCall {
  fs::path model, trajectory, record, picture;
};

void play(const Settings& settings, const PlayCall& call) {
  check_outputs({call.trajectory, call.model}, {call.record, call.picture});
  check_pictures({call.picture});
  const std::vector<haptics::TrajectoryPoint> trajectory =
      haptics::read_trajectory(call.trajectory);
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
}

}  // namespace

void add_play(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<PlayCall>();
  CLI::App* command = app.add_subcommand(
      "play", "Compute the forces along a tool's path over a model, as in the haptic loop");
  command->add_option("MODEL", call->model, "Model folder")->required();
  command
      ->add_option("--trajectory", call->trajectory,
                   "Tool positions, one per step: t,x,y,z [s, mm]")
      ->required();
  command->add_option("--record", call->record,
                      "Trace to write: t,x,y,z,cx,cy,cz,fx,fy,fz,state (f: force on the user)");
  command->add_option("--picture", call->picture, "Also draw the forces over time (PNG)");
  command->footer("Example:\n  palpate play model/ --trajectory t.csv --record trace.csv");
  command->callback([call, &settings] { play(settings, *call); });
}

}  // namespace palpate::apps
