// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "palpate/geometry/motion_smoothing.h"
#include "palpate/geometry/surface_tracker.h"

// A deforming surface in a sequence of range maps.
namespace palpate::python {
namespace {

using geometry::SmoothedMotion;
using geometry::SurfaceTracker;
using geometry::TrackedSurface;
using geometry::TrackingFigures;
using geometry::TrackingOptions;

/// A property with one of the figures.
template <typename Number>
auto figure(Number TrackingFigures::*member) {
  return [member](const TrackedSurface& found) { return found.figures.*member; };
}

/// A property with a value at each vertex.
auto vertex_values(Eigen::VectorXd geometry::DeformedSurface::*member) {
  return [member](const py::object& self) {
    return vector_view(self.cast<TrackedSurface&>().surface.*member, self);
  };
}

void add_tracked_surface(py::module_& module) {
  py::class_<TrackedSurface>(module, "TrackedSurface", "The result of SurfaceTracker.track().")
      .def_readonly("lost", &TrackedSurface::lost,
                    "Why the surface was not found; empty if it was. Read this first.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return rows_view(self.cast<TrackedSurface&>().surface.vertices, self, View::read_only);
          },
          "[mm] (V, 3) vertices of the reference at their new places.")
      .def_property_readonly(
          "distance", vertex_values(&geometry::DeformedSurface::distance),
          "[mm] (V,) signed distances from the measured surface, positive on the camera's side; "
          "NaN where nothing was measured.")
      .def_property_readonly(
          "sigma_across", vertex_values(&geometry::DeformedSurface::sigma_across),
          "[mm] (V,) standard deviations of the errors along the normal; NaN in pieces of surface "
          "of which nothing is measured, and for vertices without triangles.")
      .def_property_readonly(
          "sigma_along", vertex_values(&geometry::DeformedSurface::sigma_along),
          "[mm] (V,) the same along the surface; large where neither relief nor texture shows this "
          "motion.")
      .def_property_readonly("rms", figure(&TrackingFigures::rms),
                             "[mm] root mean square of the distances.")
      .def_property_readonly("measured", figure(&TrackingFigures::measured),
                             "Fraction of all vertices that lie on the measured surface.")
      .def_property_readonly("visible", figure(&TrackingFigures::visible),
                             "The same of the vertices that face the camera.")
      .def_property_readonly("stretch", figure(&TrackingFigures::stretch),
                             "Median relative change in edge length since the last frame.")
      .def_property_readonly("iterations", figure(&TrackingFigures::iterations),
                             "Steps of the registration.")
      .def_property_readonly("settled", figure(&TrackingFigures::settled),
                             "Whether the surface came to rest before the steps ended.");
}

void add_motion_smoothing(py::module_& module) {
  py::class_<SmoothedMotion>(module, "SmoothedMotion", "The result of smooth_motion().")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            return rows_view(self.cast<SmoothedMotion&>().positions, self);
          },
          "[mm] (V, 3)")
      .def_property_readonly(
          "velocity",
          [](const py::object& self) {
            return rows_view(self.cast<SmoothedMotion&>().velocity, self);
          },
          "[mm/s] (V, 3)")
      .def_property_readonly(
          "sigma",
          [](const py::object& self) {
            return vector_view(self.cast<SmoothedMotion&>().sigma, self);
          },
          "[mm] (V,) standard deviation of each coordinate of a position, if the errors of the "
          "frames are independent.");
  module.def(
      "smooth_motion",
      [](const py::sequence& frames, const std::vector<double>& times, double time, double window) {
        std::vector<Eigen::Matrix3Xd> positions;
        for (const py::handle frame : frames)
          positions.emplace_back(Points(frame, "frames").columns());
        const Unlocked unlocked;
        return geometry::smooth_motion(positions, times, time, window);
      },
      arg("frames"), arg("times"), arg("time"), arg("window"),
      R"(Smooths the motion of vertices without lag, as `palpate motion --window` does.

A parabola in time is fitted to each coordinate of a vertex, in the frames that are less than window
before or after time; near frames count most.
frames: the vertices at each time, (V, 3) each [mm]. times: of the frames, ascending [s]. time,
window: [s].
Raises InvalidInput, also if the window has fewer than four frames. Ctrl-C is not heard.)");
}

}  // namespace

void add_tracking(py::module_& module) {
  add_tracked_surface(module);
  add_motion_smoothing(module);
  TrackingOptions usual;
  py::class_<SurfaceTracker> tracker(
      module, "SurfaceTracker",
      R"(Follows a deforming surface from range map to range map, as `palpate track` does.

All frames get the triangles and the order of vertices of the reference.)");
  def_described(
      tracker,
      described(
          "SurfaceTracker(reference: TriangleMesh, *", "None",
          R"(reference: the surface at its pose in the first range map, such as mesh_from(map).

Raises InvalidInput.)",
          fields_of(usual)),
      py::init([](const geometry::TriangleMesh& reference, const py::kwargs& keywords) {
        TrackingOptions options;
        set_fields(fields_of(options), keywords);
        const Unlocked unlocked;
        return std::make_unique<SurfaceTracker>(options, reference);
      }),
      arg("reference"));
  tracker
      .def(
          "track",
          [](SurfaceTracker& self, const geometry::RangeMap& map, const py::object& seen) {
            const geometry::ImageF intensities =
                seen.is_none() ? geometry::ImageF() : image(seen, "image");
            const Unlocked unlocked;
            return self.track(map, {}, intensities);
          },
          arg("map"), kw_only(), arg("image") = py::none(),
          R"(Finds the surface in the next range map. If it is lost, the next one starts where this one did.

image: (rows, columns) intensity of each pixel of the map in any unit, NaN where unknown. The first
frame that is found with one tells the texture of the surface, by which later frames show how it
moves along itself.
A frame takes about a second; Ctrl-C is heard between frames. Raises InvalidInput or SolverError.)")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return rows_view(self.cast<SurfaceTracker&>().graph().mesh().triangles, self,
                             View::read_only);
          },
          "(T, 3) int32 triangles of the reference.");
}

}  // namespace palpate::python
