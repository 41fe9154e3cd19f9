// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "bindings.h"
#include "fields.h"
#include "output_path.h"
#include "palpate/core/field_text.h"
#include "palpate/haptics/device_run.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/simulated_hand.h"
#include "palpate/haptics/trajectory_device.h"
#include "trajectories.h"

// The loop between a simulated device and a model.
namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using devices::SafetyOptions;
using haptics::HandOptions;
using haptics::Playback;
using haptics::RunReport;

py::dict ticks_of_states(const RunReport& report) {
  py::dict ticks;
  for (std::size_t code = 0; code < report.states.size(); ++code)
    ticks[py::str(to_string(static_cast<haptics::ContactState>(code)))] = report.states[code];
  return ticks;
}

py::dict ticks_of_safety(const RunReport& report) {
  py::dict ticks;
  for (std::size_t i = 0; i < report.actions.size(); ++i)
    ticks[py::str(std::string(devices::safety_words()[i]))] = report.actions[i];
  return ticks;
}

void add_report(py::module_& module) {
  py::class_<RunReport>(module, "DeviceReport", "The result of play_device().")
      .def_property_readonly(
          "ticks", [](const RunReport& report) { return report.time.ticks; }, "Number of ticks.")
      .def_property_readonly("states", &ticks_of_states, "Ticks 'free', 'stick' and 'slip'.")
      .def_property_readonly("safety", &ticks_of_safety,
                             "Ticks in which the safety filter acted, by what it did.")
      .def_readonly("largest_force", &RunReport::largest_force, "[N] that was commanded.")
      .def_readonly("largest_displacement", &RunReport::largest_displacement,
                    "[mm] of the tool from the contact.")
      .def_readonly("coupling_stiffness", &RunReport::coupling_stiffness,
                    "[N/mm] of the virtual coupling; infinite without it.")
      .def_property_readonly(
          "given_energy", [](const RunReport& report) { return report.given.in_touches; },
          "[N mm] that the device gave to the user, over all touches.");
}

/// What follows the way of the tool, by its name.
std::unique_ptr<devices::Device> device_of(const std::string& name,
                                           std::vector<haptics::TrajectoryPoint> way,
                                           const HandOptions& hand) {
  using haptics::PathShape;
  const auto shape = choose<std::optional<PathShape>>(
      "device", name,
      {{"hand", std::nullopt}, {"scripted", PathShape::smooth}, {"recorded", PathShape::linear}});
  haptics::TimedPath path(std::move(way), shape.value_or(PathShape::smooth));
  if (!shape) return std::make_unique<haptics::SimulatedHand>(std::move(path), hand);
  return std::make_unique<haptics::TrajectoryDevice>(
      std::move(path), haptics::TrajectoryDeviceOptions{.period = hand.period()});
}

/// The other devices read no field of the hand but its rate.
void refuse_idle_fields(const std::string& device, const py::kwargs& keywords) {
  HandOptions hand;
  for (const FieldText& field : texts_of(fields_of(hand))) {
    if (field.name != "rate" && keywords.contains(field.name.c_str())) {
      throw InvalidInput(field.name + ": does nothing with device='" + device +
                         "'; it needs device='hand'");
    }
  }
}

void add_play(py::module_& module) {
  haptics::DeviceLoopOptions usual;
  HandOptions usual_hand;
  def_with_fields(
      module, fields_of_all(usual.coupling, usual.safety, usual_hand),
      "play_device(playback: Playback, tools: ArrayLike, times: ArrayLike | None = None, *, "
      "device: "
      "Literal['hand', 'scripted', 'recorded'] = 'hand', record: str | PathLike | None = None",
      "DeviceReport",
      R"(Closes the loop between a model and a simulated device, as `palpate play --device` does.

tools: [mm] (N, 3) where the device or its hand wants to be; times: (N,) [s]; None: 1 kHz.
device: 'hand', which the forces move, or one that follows the way whatever it feels: 'scripted'
smoothly, at rest in each point, 'recorded' straight.
record: file to write, for read_device_trace().
Of the hand's options, the other devices take only rate. Raises InvalidInput or OutputError. Ctrl-C
is not heard.)",
      [](const std::shared_ptr<Playback>& playback, const py::object& tools,
         const py::object& times, const std::string& device, const std::optional<fs::path>& record,
         const py::kwargs& keywords) {
        haptics::DeviceLoopOptions loop;
        HandOptions hand;
        set_fields(fields_of_all(loop.coupling, loop.safety, hand), keywords);
        static_cast<void>(in_range(hand));
        if (record) static_cast<void>(output_path(*record));
        if (device != "hand") refuse_idle_fields(device, keywords);
        std::vector<haptics::TrajectoryPoint> way = trajectory(tools, times);
        if (way.empty()) throw InvalidInput("tools: must have at least one position");
        const double duration = std::max(way.back().time - way.front().time, hand.period());
        const Unlocked unlocked;
        const std::unique_ptr<devices::Device> opened = device_of(device, std::move(way), hand);
        haptics::DeviceRun run(
            *opened, playback, loop,
            {.duration = duration, .real_time = false, .record = record.value_or(fs::path())});
        return run.finish();
      },
      arg("playback"), arg("tools"), arg("times") = py::none(), kw_only(), arg("device") = "hand",
      arg("record") = py::none());
  module.def(
      "read_device_trace",
      [](const fs::path& path) {
        const Unlocked unlocked;
        return Trace{haptics::trace_of(haptics::read_loop_record(path))};
      },
      arg("path"),
      R"(The trace of the tool in a record of play_device(), or of `palpate play --session`.

Raises FileError.)");
}

}  // namespace

void add_device(py::module_& module) {
  add_report(module);
  add_play(module);
}

}  // namespace palpate::python
