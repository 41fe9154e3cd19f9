// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "palpate/geometry/cloud_ball.h"
#include "palpate/probing/ball_placement.h"
#include "palpate/probing/touch_placement.h"

namespace palpate::python {
namespace {

using geometry::SeenBall;
using probing::ArmPlacement;
using probing::BallPlacement;
using probing::PlacementResidual;

void add_placement(py::module_& module) {
  py::class_<ArmPlacement>(module, "ArmPlacement",
                           "The pose of an arm's base in the frame of a camera.")
      .def_property_readonly(
          "T_camera_base",
          [](const ArmPlacement& placement) { return copy_of(placement.T_camera_base.matrix()); },
          "(4, 4) maps coordinates of the base [mm] to those of the camera.")
      .def_readonly("determined", &ArmPlacement::determined,
                    "Whether the pose can be used. Read this before you use it.")
      .def_readonly("reason", &ArmPlacement::reason, "Why, in a sentence with figures.")
      .def_property_readonly(
          "centre", [](const ArmPlacement& placement) { return copy_of(placement.centre); },
          "[mm] (3,) mean of the used positions, frame of the camera.")
      .def_property_readonly(
          "covariance", [](const ArmPlacement& placement) { return copy_of(placement.covariance); },
          "(6, 6) of the rotation about the centre [rad] and the shift of the centre [mm].")
      .def_readonly("rms", &ArmPlacement::rms, "[mm] of the distances of the used measurements.")
      .def_property_readonly(
          "distances",
          [](const ArmPlacement& placement) {
            return gather<double>(placement.residuals, [](const PlacementResidual& residual) {
              return residual.distance;
            });
          },
          "[mm] (N,) of each measurement from where it should be; NaN if it is not known.")
      .def_property_readonly(
          "used",
          [](const ArmPlacement& placement) {
            return gather<bool>(placement.residuals,
                                [](const PlacementResidual& residual) { return residual.used; });
          },
          "(N,) bool: false for measurements that contradict the others.")
      .def_property_readonly(
          "further_tip",
          [](const ArmPlacement& placement) -> std::optional<py::array> {
            if (!placement.advice) return std::nullopt;
            return copy_of(placement.advice->tip_base);
          },
          "[mm] (3,) position of the tip, frame of the base, where one more measurement would help "
          "most; None if none would.")
      .def_readonly("doubts", &ArmPlacement::doubts, "What is unlikely about the measurements.")
      .def("__repr__", [](const ArmPlacement& placement) {
        return "<palpate.ArmPlacement: " +
               std::string(placement.determined ? "" : "not determined: ") + placement.reason + ">";
      });
  py::class_<BallPlacement, ArmPlacement>(module, "BallPlacement",
                                          "The result of place_arm_by_ball().")
      .def_property_readonly(
          "offset", [](const BallPlacement& placement) { return copy_of(placement.offset); },
          "[mm] (3,) from the tip to the centre of the ball, in axes of the tip.")
      .def_property_readonly(
          "offset_deviation",
          [](const BallPlacement& placement) -> std::optional<py::array> {
            if (!placement.offset_deviation) return std::nullopt;
            return copy_of(*placement.offset_deviation);
          },
          "[mm] (3,) its standard deviations; None if the ball is assumed to be at the tip.");
}

void add_ball(py::module_& module) {
  py::class_<SeenBall>(module, "SeenBall", "A ball of known radius in a view of a scene.")
      .def_property_readonly(
          "centre", [](const SeenBall& ball) { return copy_of(ball.centre); }, "[mm] (3,)")
      .def_readonly("radius", &SeenBall::radius,
                    "[mm] of the sphere that fits the points best; tells whether the given one is "
                    "right.")
      .def_readonly("points", &SeenBall::points, "Number of points on the ball.")
      .def_readonly("rms", &SeenBall::rms, "[mm] of their distances from the sphere.");
  module.def(
      "find_ball",
      [](const py::object& points, const py::object& normals, double radius) {
        const Points given(points, "points"), directions(normals, "normals");
        const Unlocked while_it_searches;
        return geometry::find_ball(given.columns(), directions.columns(), radius);
      },
      arg("points"), arg("normals"), arg("radius"),
      R"(The ball of this radius [mm] of which (N, 3) points show a part, beside anything else.

normals: (N, 3) of unit length, towards the camera, which is at the origin.
None if there is no such ball. Raises InvalidInput. Ctrl-C is not heard.)");
}

std::vector<probing::HeldBall> held_balls(const py::object& tips,
                                          const std::vector<std::optional<SeenBall>>& seen,
                                          const py::object& orientations) {
  const Points given(tips, "tips");
  const auto count = static_cast<std::size_t>(given.columns().cols());
  if (seen.size() != count)
    throw InvalidInput("balls: there are " + std::to_string(seen.size()) + "; there must be " +
                       std::to_string(count) + ", one or None for each of the tips");
  std::vector<probing::HeldBall> balls(count);
  for (std::size_t i = 0; i < count; ++i) {
    balls[i].tip = given.columns().col(static_cast<Eigen::Index>(i));
    balls[i].seen = seen[i];
  }
  if (orientations.is_none()) return balls;
  const py::array_t<double> turns = real_numbers(orientations, "orientations");
  if (turns.ndim() != 2 || turns.shape(0) != static_cast<py::ssize_t>(count) || turns.shape(1) != 4)
    throw InvalidInput(
        "orientations: must have the shape (N, 4), a quaternion x, y, z, w for each of the tips");
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    balls[i].R_base_tip =
        Eigen::Quaterniond(turns.at(row, 3), turns.at(row, 0), turns.at(row, 1), turns.at(row, 2));
  }
  return balls;
}

void add_functions(py::module_& module) {
  def_with_options<probing::TouchPlacementOptions>(
      module,
      "place_arm_by_touches(tips: ArrayLike, surface: TriangleMesh, *, start: ArrayLike | None = "
      "None",
      "ArmPlacement",
      R"(The pose of an arm's base from touches of a surface that the camera knows.

tips: (N, 3) positions of the tip's centre [mm], frame of the base.
surface: frame of the camera; its normals point to where the tip comes from.
start: (4, 4) rough pose; None: all poses are searched.
A pose that the touches do not determine is a result, not an error: see `determined`.
Raises InvalidInput. Ctrl-C is not heard.)",
      [](const py::object& tips, const geometry::TriangleMesh& surface, const py::object& start,
         const py::kwargs& keywords) {
        const Points given(tips, "tips");
        auto options = options_from<probing::TouchPlacementOptions>(keywords);
        if (!start.is_none()) options.T_camera_base_start = isometry(start, "start");
        const Unlocked while_it_searches;
        return probing::place_by_touches(given.columns(), surface, options);
      },
      arg("tips"), arg("surface"), kw_only(), arg("start") = py::none());
  module.def(
      "place_arm_by_ball",
      [](const py::object& tips, const std::vector<std::optional<SeenBall>>& balls,
         double ball_radius, const py::object& orientations) {
        const std::vector<probing::HeldBall> held = held_balls(tips, balls, orientations);
        const Unlocked while_it_fits;
        return probing::place_by_ball(held, ball_radius);
      },
      arg("tips"), arg("balls"), arg("ball_radius"), kw_only(), arg("orientations") = py::none(),
      R"(The pose of an arm's base from a ball that the arm holds and the camera sees.

tips: (N, 3) positions of the tip [mm], frame of the base.
balls: what find_ball() found at each; None where it found none.
orientations: (N, 4) unit quaternions x, y, z, w that turn directions of the tip into those of the
base; with them, the offset of the ball from the tip is estimated.
A pose that the positions do not determine is a result, not an error: see `determined`.
Raises InvalidInput. Ctrl-C is not heard.)");
}

}  // namespace

void add_arm_placement(py::module_& module) {
  add_ball(module);
  add_placement(module);
  add_functions(module);
}

}  // namespace palpate::python
