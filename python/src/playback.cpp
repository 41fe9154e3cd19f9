// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/playback.h"

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "output_path.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/deformed_shape.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/trajectory_file.h"
#include "trajectories.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using haptics::BlendedField;
using haptics::Command;
using haptics::ContactMotion;
using haptics::LoopState;
using haptics::Model;
using haptics::Playback;
using haptics::PlaybackOptions;
using haptics::TracePoint;
using haptics::TrajectoryPoint;

constexpr double kPeriod = 1e-3;  // [s] of 1 kHz

void add_tick(py::module_& module) {
  py::class_<LoopState>(module, "LoopState", R"(What the loop remembers from tick to tick.

One for each tool and Playback; a new one starts afresh.)")
      .def(py::init<>())
      .def_property_readonly(
          "state", [](const LoopState& state) { return to_string(state.contact_state); },
          "'free', 'stick' or 'slip', after the last tick.");
  py::class_<Command>(module, "Command", "The result of one tick.")
      .def_property_readonly(
          "force", [](const Command& command) { return copy_of(command.force); },
          "[N] (3,) on the user, world frame: minus that on the object.")
      .def_property_readonly(
          "contact", [](const Command& command) { return copy_of(command.contact); },
          "[mm] (3,) the contact on the undeformed surface; the tool while it is free.")
      .def_property_readonly(
          "state", [](const Command& command) { return to_string(command.state); },
          "'free', 'stick' or 'slip'.")
      .def_readonly("started_inside", &Command::started_inside,
                    "The tool was inside the object when the loop started.")
      .def_readonly("held", &Command::held, "The tool's position was not usable.")
      .def_readonly("limited", &Command::limited, "By largest_jump.");
}

/// A property of a trace: the numbers of each point from a member on, as a view.
template <typename Member>
auto of_points(Member member, py::ssize_t numbers) {
  return [member, numbers](const py::object& self) -> py::array {
    const auto& points = self.cast<const Trace&>().points;
    constexpr auto kPoint = static_cast<py::ssize_t>(sizeof(TracePoint));
    constexpr auto kNumber = static_cast<py::ssize_t>(sizeof(double));
    const auto count = static_cast<py::ssize_t>(points.size());
    const auto* first =
        points.empty() ? nullptr : reinterpret_cast<const double*>(&(points.front().*member));
    if (numbers == 1) return view(first, {count}, {kPoint}, self);
    return view(first, {count, numbers}, {kPoint, kNumber}, self);
  };
}

py::array states_of(const Trace& trace) {
  const py::array_t<int> codes = gather<int>(
      trace.points, [](const TracePoint& point) { return static_cast<int>(point.state); });
  py::list names;
  for (int code = 0; code < 3; ++code)
    names.append(to_string(static_cast<haptics::ContactState>(code)));
  return py::module_::import("numpy").attr("take")(names, codes);
}

void add_trace(py::module_& module) {
  py::class_<Trace>(module, "Trace",
                    "What a tool felt on its way; arrays are views that keep it alive.")
      .def_property_readonly("time", of_points(&TracePoint::time, 1), "[s] (N,)")
      .def_property_readonly("tool", of_points(&TracePoint::tool, 3), "[mm] (N, 3) of the tool.")
      .def_property_readonly(
          "contact", of_points(&TracePoint::contact, 3),
          "[mm] (N, 3) the contact on the undeformed surface; the tool while it is free.")
      .def_property_readonly("force", of_points(&TracePoint::force, 3),
                             "[N] (N, 3) on the user: minus that on the object.")
      .def_property_readonly("state", &states_of, "(N,) 'free', 'stick' or 'slip' (a copy).")
      .def("__len__", [](const Trace& trace) { return trace.points.size(); })
      .def(
          "write",
          [](const Trace& trace, const fs::path& path) {
            const Unlocked unlocked;
            haptics::write_trace(output_path(path), trace.points);
          },
          arg("path"), "Writes the CSV file of `palpate play --record`. Raises OutputError.");
  module.def(
      "read_trajectory",
      [](const fs::path& path) {
        const std::vector<TrajectoryPoint> read = haptics::read_trajectory_file(path);
        return py::make_tuple(
            gather_rows(read, [](const TrajectoryPoint& point) { return point.tool; }),
            gather<double>(read, [](const TrajectoryPoint& point) { return point.time; }));
      },
      arg("path"),
      R"(Reads the way of a tool (CSV with the columns t,x,y,z, or binary): tools (N, 3) [mm], times (N,) [s].

Raises FileError.)");
}

void check_pairs(const Points& places, const Points& displacements) {
  if (places.columns().cols() == displacements.columns().cols()) return;
  throw InvalidInput("displacements: has " + std::to_string(displacements.columns().cols()) +
                     " rows; it must have " + std::to_string(places.columns().cols()) +
                     ", one for each of the places");
}

void add_field(py::module_& module) {
  py::class_<BlendedField>(module, "BlendedField",
                           "The force field of a model at any place of its surface.")
      .def(py::init([](const Model& model) {
             const Unlocked unlocked;
             return std::make_unique<BlendedField>(model);
           }),
           arg("model"), "Prepares what forces need; the model may be changed or forgotten.")
      .def(
          "force",
          [](const BlendedField& field, const py::object& places, const py::object& displacements) {
            const Points at(places, "places"), moved(displacements, "displacements");
            check_pairs(at, moved);
            Eigen::Matrix3Xd forces(3, at.columns().cols());
            {
              const Unlocked unlocked;
              for (Eigen::Index i = 0; i < forces.cols(); ++i)
                forces.col(i) = field.force(at.columns().col(i), moved.columns().col(i));
            }
            return own_rows(std::move(forces));
          },
          arg("places"), arg("displacements"),
          R"([N] (N, 3) force of the tool on the object, where contacts at `places` (N, 3) [mm] are displaced by
`displacements` (N, 3) [mm], all in the world frame. A user feels the opposite.

For a point off the surface, the nearest point on it is used; a point that is not finite has no force.
Raises InvalidInput. Ctrl-C is not heard.)")
      .def(
          "deviation",
          [](const BlendedField& field, const py::object& places, const py::object& displacements) {
            const Points at(places, "places"), moved(displacements, "displacements");
            check_pairs(at, moved);
            py::array_t<double> deviations(at.columns().cols());
            for (Eigen::Index i = 0; i < at.columns().cols(); ++i) {
              deviations.mutable_at(i) =
                  field.deviation(at.columns().col(i), moved.columns().col(i))
                      .value_or(std::numeric_limits<double>::quiet_NaN());
            }
            return deviations;
          },
          arg("places"), arg("displacements"),
          "[N] (N,) how far these forces may be off, as the model states it; NaN where it does "
          "not.");
  module.def(
      "drawn_shape",
      [](const geometry::TriangleMesh& surface, const py::object& contact,
         const py::object& displacement, double tip, double reach) {
        const Eigen::Vector3d place = vector3(contact, "contact");
        const Eigen::Vector3d moved = vector3(displacement, "displacement");
        if (!place.allFinite()) throw InvalidInput("contact: is not finite");
        Eigen::Matrix3Xd shape;
        {
          const Unlocked unlocked;
          const geometry::SurfacePoint at = geometry::SurfaceQuery(surface).closest_point(place).at;
          if (at.triangle < 0) {
            throw InvalidInput(
                "contact: is so far from the surface that its distance overflows; are both in mm?");
          }
          shape = haptics::drawn_shape(surface, at, moved, {.tip = tip, .reach = reach});
        }
        return own_rows(std::move(shape));
      },
      arg("surface"), arg("contact"), arg("displacement"), kw_only(),
      arg("tip") = haptics::DrawnShapeOptions{}.tip,
      arg("reach") = haptics::DrawnShapeOptions{}.reach,
      R"([mm] (V, 3) the vertices with a dent, for pictures: DRAWN, NOT MEASURED.

contact: [mm] (3,) the surface's nearest place moves by `displacement` [mm] (3,).
tip: [mm] along the surface that follows the contact.
reach: of the dent beyond the tip, in lengths of the displacement.
Raises InvalidInput.)");
  module.def(
      "displayed_shape",
      [](const Model& model, const LoopState& state, bool nearest) {
        if (state.proxy.at.triangle >= model.surface.triangles.cols())
          throw InvalidInput("state: is that of another model");
        Eigen::Matrix3Xd shape;
        {
          const Unlocked unlocked;
          shape = haptics::displayed_shape(
              model, BlendedField(model), model.surface, state,
              nearest ? haptics::ShapeRule::nearest : haptics::ShapeRule::blended);
        }
        return own_rows(std::move(shape));
      },
      arg("model"), arg("state"), kw_only(), arg("nearest") = false,
      R"([mm] (V, 3) the vertices of the surface as they are displayed in a state of playback.

Undeformed while the tool is free. Otherwise they follow the surfaces that were recorded
(`palpate fit --shapes`); without any, they are those of `drawn_shape`.

nearest: show the recorded surface that is nearest, as it is, instead of a blend of them.
Raises InvalidInput.)");
}

void add_loop(py::module_& module) {
  PlaybackOptions usual;
  py::class_<Playback, std::shared_ptr<Playback>> added(module, "Playback",
                                                        "The haptic loop of a model, at 1 kHz.");
  def_described(
      added,
      described("__init__(self: Playback, model: Model, *", "None",
                "Prepares all that a tick needs; the model may be changed or forgotten afterwards. "
                "Raises InvalidInput.",
                fields_of(usual)),
      py::init([](const Model& model, const py::kwargs& keywords) {
        PlaybackOptions options;
        set_fields(fields_of(options), keywords);
        const Unlocked unlocked;
        return Playback(model, options);
      }),
      arg("model"));
  added
      .def(
          "step",
          [](const Playback& playback, const py::object& tool, LoopState& state, double seconds) {
            return playback.step(vector3(tool, "tool"), state, seconds);
          },
          arg("tool"), arg("state"), arg("seconds") = kPeriod,
          R"(One tick: the force at a position of the tool [mm] (3,), world frame; `state` changes.

A position that is not finite or too far from the last is not used: `Command.held`.
seconds: since the last tick; counts only where the model depends on the rate.
Use one state in one thread at a time. The interpreter stays locked: a tick takes microseconds.)")
      .def(
          "play",
          [](const Playback& playback, const py::object& tools, const py::object& times) {
            const std::vector<TrajectoryPoint> points = trajectory(tools, times);
            const Unlocked unlocked;
            return Trace{haptics::play(playback, points)};
          },
          arg("tools"), arg("times") = py::none(),
          R"(Plays the positions (N, 3) [mm] of a tool, from a new state.

times: (N,) [s]; None: 1 kHz. Raises InvalidInput. Other threads of Python run meanwhile; Ctrl-C is
not heard.)");
}

}  // namespace

std::vector<TrajectoryPoint> trajectory(const py::object& tools, const py::object& times) {
  const Points given(tools, "tools");
  const auto positions = given.columns();
  std::vector<TrajectoryPoint> points(static_cast<std::size_t>(positions.cols()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {kPeriod * static_cast<double>(i), positions.col(static_cast<Eigen::Index>(i))};
  }
  if (times.is_none()) return points;
  const py::array_t<double> at = real_numbers(times, "times");
  if (at.ndim() != 1 || at.size() != positions.cols()) {
    throw InvalidInput("times: must have the shape (" + std::to_string(positions.cols()) +
                       ",), one time for each of the tools");
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].time = at.data()[i];
    if (!std::isfinite(points[i].time) || (i > 0 && points[i].time < points[i - 1].time)) {
      throw InvalidInput("times[" + std::to_string(i) + "] is " + std::to_string(points[i].time) +
                         "; times must be finite and not decrease");
    }
  }
  return points;
}

void add_playback(py::module_& module) {
  add_tick(module);
  add_trace(module);
  add_field(module);
  add_loop(module);
}

}  // namespace palpate::python
