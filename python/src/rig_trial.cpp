// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "frames.h"
#include "palpate/sensing/pattern_image.h"
#include "palpate/sensing/reason.h"
#include "palpate/sensing/rig_assessment.h"

// Simulates the measurements of a rig on bodies.
namespace palpate::python {
namespace {

using sensing::Body;
using sensing::RigAssessment;
using sensing::RigTrial;

/// A property of the errors of a trial.
auto error_figure(double geometry::ErrorStatistics::*member) {
  return [member](const RigAssessment& found) { return found.score.error.*member; };
}

void add_body(py::module_& module) {
  py::class_<Body>(module, "Body", "An object in front of a simulated rig.")
      .def(py::init([](const geometry::TriangleMesh& mesh, const py::object& reflectance,
                       const py::object& vertex_colors, const py::object& end_vertices,
                       double specular, double shininess) {
             Body body{.mesh = mesh, .specular = specular, .shininess = shininess};
             body.reflectance = vector3(reflectance, "reflectance");
             if (!vertex_colors.is_none())
               body.vertex_colors = Points(vertex_colors, "vertex_colors").columns();
             if (!end_vertices.is_none())
               body.end_vertices = Points(end_vertices, "end_vertices").columns();
             return body;
           }),
           arg("mesh"), kw_only(), py::arg_v("reflectance", py::make_tuple(0.8, 0.8, 0.8), "..."),
           arg("vertex_colors") = py::none(), arg("end_vertices") = py::none(),
           arg("specular") = 0., arg("shininess") = 50.,
           R"(mesh: [mm] in the camera's frame: x to the right, y down, z away from the camera.

reflectance: red, green, blue in [0, 1]; 0.8 each if not given. vertex_colors: (V, 3), multiplied with it.
end_vertices: [mm] (V, 3) vertices at the end of the exposure; None: the body is at rest.
specular: strength of the highlight, in [0, 1]. shininess: its exponent, >= 1.
try_rig() raises InvalidInput if a value is not in its range.)");
}

void add_assessment(py::module_& module) {
  py::class_<RigAssessment>(
      module, "RigAssessment",
      "How much of the bodies was measured, in pixels, and how well. A depth is wrong if it is "
      "more than 1 % of the distance off; the errors are those of the others.")
      .def_readonly("visible", &RigAssessment::visible, "Pixels that see a body.")
      .def_readonly("outside", &RigAssessment::outside,
                    "Of these, outside the projector's field of view.")
      .def_readonly("dark", &RigAssessment::dark, "Of these, in shadow or facing away.")
      .def_property_readonly(
          "lit", [](const RigAssessment& found) { return found.score.measurable; },
          "Of these, lit: the ones that can be measured.")
      .def_property_readonly(
          "coverage", [](const RigAssessment& found) { return found.score.coverage; },
          "Share of the lit pixels that have a depth.")
      .def_property_readonly(
          "wrong_share", [](const RigAssessment& found) { return found.score.wrong_share; },
          "Share of the measured pixels whose depth is wrong.")
      .def_property_readonly(
          "reasons",
          [](const RigAssessment& found) {
            py::dict counts;
            for (int code = 0; code < sensing::kReasonCount; ++code) {
              counts[py::str(std::string(sensing::name(static_cast<sensing::Reason>(code))))] =
                  found.reasons[static_cast<std::size_t>(code)];
            }
            return counts;
          },
          "Number of lit pixels by reason, in the order of the codes.")
      .def_property_readonly("median", error_figure(&geometry::ErrorStatistics::median),
                             "[mm] median absolute error.")
      .def_property_readonly("rms", error_figure(&geometry::ErrorStatistics::rms),
                             "[mm] root mean square error.")
      .def_property_readonly("p95", error_figure(&geometry::ErrorStatistics::p95),
                             "[mm] 95 % of the absolute errors are smaller.")
      .def_property_readonly(
          "difference",
          [](const py::object& self) {
            return image_view(self.cast<RigAssessment&>().score.difference, self);
          },
          "[mm] (height, width) float32 measured minus true depth; NaN where the depth is wrong or "
          "unknown.");
}

void add_trial(py::module_& module) {
  py::class_<RigTrial>(module, "RigTrial", "The result of try_rig().")
      .def_property_readonly(
          "frame",
          [](const RigTrial& trial) { return pixels_of(trial.simulation.frames[0].clone()); },
          "What the camera sees of the bodies under the pattern, as read_frame() gives it.")
      .def_property_readonly(
          "training",
          [](const RigTrial& trial) {
            py::dict frames;
            for (const sensing::NamedImages& color : trial.training)
              frames[py::str(color.name)] = pixels_of(color.images[0].clone());
            return frames;
          },
          "The same under each colour of the pattern alone, by its name.")
      .def_property_readonly(
          "truth", [](const RigTrial& trial) { return trial.simulation.truth.range; },
          "RangeMap of the true depths (a copy).")
      .def_property_readonly(
          "body",
          [](const py::object& self) {
            return image_view(self.cast<RigTrial&>().simulation.truth.body, self);
          },
          "(height, width) int32 number of the body that each pixel sees; -1: none.")
      .def_property_readonly(
          "lit",
          [](const py::object& self) {
            return image_view(self.cast<RigTrial&>().simulation.truth.lit, self);
          },
          "(height, width) bool: the projector's light reaches what the pixel sees.")
      .def_readonly("decoded", &RigTrial::decoded,
                    "DecodeResult; None if nothing could be decoded.")
      .def_readonly("failure", &RigTrial::failure, "Why decoded is None; empty otherwise.")
      .def(
          "assess",
          [](const RigTrial& trial, std::optional<int> counted_bodies) {
            if (!trial.decoded) throw InvalidInput("assess: nothing was decoded: " + trial.failure);
            return sensing::assess(*trial.decoded, trial.simulation.truth,
                                   {.counted_bodies = counted_bodies});
          },
          kw_only(), arg("counted_bodies") = py::none(),
          R"(Compares the decoded depths with the truth.

counted_bodies: only the first ones count, the others are scenery such as a wall; None: all.
Raises InvalidInput if nothing was decoded.)");
}

}  // namespace

void add_rig_trial(py::module_& module) {
  add_body(module);
  add_assessment(module);
  add_trial(module);
  sensing::VirtualSensor usual_sensor;
  sensing::DecodeOptions usual_options;
  def_with_fields(
      module, fields_of_all(usual_sensor, usual_options),
      "try_rig(rig: Rig, pattern: Pattern, bodies: Sequence[Body], *", "RigTrial",
      R"(Simulates a measurement: the pattern on the bodies, the camera's frames, training and decoding.

The pattern is drawn for the rig. If it has no stripes, the lit pixel nearest to the centre of the
image is its anchor. Raises InvalidInput. Ctrl-C is not heard: it takes seconds.)",
      [](const sensing::Rig& rig, const sensing::Pattern& pattern, const std::vector<Body>& bodies,
         const py::kwargs& keywords) {
        sensing::VirtualSensor sensor;
        sensing::TrialOptions options;
        set_fields(fields_of_all(sensor, options.decode), keywords);
        const Unlocked unlocked;
        options.decoder_rig = sensing::rig_of_drawing(rig);
        return sensing::try_rig(rig, pattern, sensing::draw_pattern(pattern, rig), bodies, sensor,
                                options);
      },
      arg("rig"), arg("pattern"), arg("bodies"));
}

}  // namespace palpate::python
