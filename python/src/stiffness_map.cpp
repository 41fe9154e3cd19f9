// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/stiffness_map.h"

#include <optional>
#include <vector>

#include "arrays.h"
#include "bindings.h"

namespace palpate::python {
namespace {

using probing::CheckedAcquisition;
using probing::StiffnessMap;

StiffnessMap map_of(const CheckedAcquisition& acquisition, const geometry::TriangleMesh& surface,
                    const std::optional<double>& force, const probing::PressNoise& noise) {
  const double pressed = force.value_or(probing::common_press_force(acquisition));
  if (!(pressed > 0))
    throw InvalidInput("stiffness_map(): no contact was pressed without a tangential force");
  return probing::stiffness_map(surface, probing::contact_stiffness(acquisition, pressed, noise));
}

}  // namespace

void add_stiffness_map(py::module_& module) {
  py::class_<StiffnessMap>(module, "StiffnessMap",
                           "How stiff an object feels along its surface of V vertices.")
      .def_property_readonly(
          "stiffness",
          [](const py::object& map) {
            return vector_view(map.cast<const StiffnessMap&>().stiffness, map);
          },
          "[N/mm] (V,) a normal force over its depth; NaN where no contact is near.")
      .def_property_readonly(
          "deviation",
          [](const py::object& map) {
            return vector_view(map.cast<const StiffnessMap&>().deviation, map);
          },
          "[N/mm] (V,) standard deviation of `stiffness`.")
      .def_readonly("soft", &StiffnessMap::soft, "[N/mm] median over the surface.")
      .def_readonly("stiff", &StiffnessMap::stiff, "[N/mm] highest value at a contact.")
      .def_readonly("stiff_deviation", &StiffnessMap::stiff_deviation,
                    "[N/mm] standard deviation of `stiff`.")
      .def_property_readonly(
          "stiffest", [](const StiffnessMap& map) { return copy_of(map.stiffest); },
          "[mm] (3,) the contact of `stiff`.")
      .def_readonly("threshold", &StiffnessMap::threshold,
                    "[N/mm] of the contour, midway between `soft` and `stiff`.")
      .def_readonly("distinct", &StiffnessMap::distinct,
                    "Whether `stiff` exceeds `soft` by three standard deviations. If not, the map "
                    "and the contour show nothing but noise.")
      .def_readonly("area", &StiffnessMap::area, "[mm^2] of the surface inside the contour.")
      .def_property_readonly(
          "contour",
          [](const StiffnessMap& map) {
            return own_rows(Eigen::Matrix3Xd(map.contour))
                .attr("reshape")(map.contour.cols() / 2, 2, 3);
          },
          "[mm] (N, 2, 3) ends of the segments of the contour.");
  module.def(
      "stiffness_map",
      [](const CheckedAcquisition& acquisition, const geometry::TriangleMesh& surface,
         const std::optional<double>& force, double position_noise, double force_noise) {
        const Unlocked while_it_works;
        return map_of(acquisition, surface, force,
                      {.position = position_noise, .force = force_noise});
      },
      arg("acquisition"), arg("surface"), kw_only(), arg("force") = py::none(),
      arg("position_noise") = probing::PressNoise{}.position,
      arg("force_noise") = probing::PressNoise{}.force,
      R"(Interpolates the stiffness of the contacts along a surface, to find a stiff part below it.

force: [N] normal force under which the contacts are compared; None: the largest that three quarters of
them reach.
position_noise [mm], force_noise [N]: standard deviations of the presses.
The contour encloses what feels stiffer, for whatever reason; it is wider than a deep part, and says
nothing of its depth. `palpate probe report` draws it. Raises InvalidInput. Ctrl-C is not heard.)");
}

}  // namespace palpate::python
