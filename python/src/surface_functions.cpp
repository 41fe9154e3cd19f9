// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/registration.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/winding_number.h"
#include "places.h"

namespace palpate::python {
namespace {

using geometry::AllHits;
using geometry::FirstHits;
using geometry::Registration;
using geometry::RegistrationOptions;
using geometry::SurfaceQuery;
using geometry::TriangleMesh;
using geometry::WindingNumber;

/// A query with the size of its mesh.
struct QueriedMesh {
  SurfaceQuery query;
  MeshSize size;
};

void add_queries(py::module_& module) {
  py::class_<PlacesOnMesh>(module, "ClosestPoints",
                           "Closest points of N points; arrays are views that keep it alive.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return vector_view(self.cast<PlacesOnMesh&>().triangles, self);
          },
          "(N,) int32; -1 for a point that is not finite.")
      .def_property_readonly(
          "barycentric",
          [](const py::object& self) {
            return rows_view(self.cast<PlacesOnMesh&>().barycentric, self);
          },
          "(N, 3) in the order of the triangle's vertices; 0 without a closest point.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            return rows_view(self.cast<PlacesOnMesh&>().positions, self);
          },
          "[mm] (N, 3); NaN without a closest point.")
      .def_property_readonly(
          "distances",
          [](const py::object& self) {
            return vector_view(self.cast<PlacesOnMesh&>().distances, self);
          },
          "[mm] (N,); NaN without a closest point.");
  py::class_<FirstHits>(module, "FirstHits",
                        "First crossings of N segments; arrays are views that keep it alive.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return vector_view(self.cast<FirstHits&>().triangles, self);
          },
          "(N,) int32; -1 without a crossing.")
      .def_property_readonly(
          "barycentric",
          [](const py::object& self) {
            return rows_view(self.cast<FirstHits&>().barycentric, self);
          },
          "(N, 3) in the order of the triangle's vertices; 0 without a crossing.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) { return rows_view(self.cast<FirstHits&>().positions, self); },
          "[mm] (N, 3); NaN without a crossing.")
      .def_property_readonly(
          "along",
          [](const py::object& self) { return vector_view(self.cast<FirstHits&>().along, self); },
          "(N,) share of the way; NaN without a crossing.");
  py::class_<AllHits>(module, "AllHits",
                      "All M crossings of N segments, in the order of the segments and along each; "
                      "arrays are views that keep it alive.")
      .def_property_readonly(
          "segments",
          [](const py::object& self) { return vector_view(self.cast<AllHits&>().segments, self); },
          "(M,) int32, ascending: which segment crosses.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) { return vector_view(self.cast<AllHits&>().triangles, self); },
          "(M,) int32.")
      .def_property_readonly(
          "barycentric",
          [](const py::object& self) { return rows_view(self.cast<AllHits&>().barycentric, self); },
          "(M, 3) in the order of the triangle's vertices.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) { return rows_view(self.cast<AllHits&>().positions, self); },
          "[mm] (M, 3).")
      .def_property_readonly(
          "along",
          [](const py::object& self) { return vector_view(self.cast<AllHits&>().along, self); },
          "(M,) share of the way.");
  py::class_<QueriedMesh>(module, "SurfaceQuery",
                          "Closest points on a mesh, and crossings of it, exact in float64.")
      .def(py::init([](const TriangleMesh& mesh) {
             const Unlocked unlocked;
             return QueriedMesh{SurfaceQuery(mesh), mesh_size(mesh)};
           }),
           arg("mesh"),
           R"(Prepares a copy of the mesh: moving its vertices later does not matter here.

Raises InvalidInput if the mesh has no triangle, a vertex that is not finite, or a wrong index.)")
      .def(
          "closest_points",
          [](const QueriedMesh& of, const py::object& points) {
            const Points given(points, "points");
            const Unlocked unlocked;
            return PlacesOnMesh{geometry::closest_points(of.query, given.columns()), of.size};
          },
          arg("points"),
          R"(The closest point of the surface to each of (N, 3) points [mm], on all processors.

A C-contiguous float64 array is read in place. Ctrl-C is not heard.)")
      .def(
          "first_hits",
          [](const QueriedMesh& of, const py::object& starts, const py::object& ends) {
            const Points from(starts, "starts"), to(ends, "ends");
            const Unlocked unlocked;
            return geometry::first_hits(of.query, from.columns(), to.columns());
          },
          arg("starts"), arg("ends"),
          R"(The first crossing of the surface on the way from each start to its end, (N, 3) each [mm].

Raises InvalidInput unless there are as many ends as starts. Ctrl-C is not heard.)")
      .def(
          "all_hits",
          [](const QueriedMesh& of, const py::object& starts, const py::object& ends) {
            const Points from(starts, "starts"), to(ends, "ends");
            const Unlocked unlocked;
            return geometry::all_hits(of.query, from.columns(), to.columns());
          },
          arg("starts"), arg("ends"),
          R"(All crossings of the surface on the way from each start to its end, (N, 3) each [mm].

A segment exactly through an edge or a vertex counts as if it passed beside it, so that no crossing
counts twice. Raises InvalidInput unless there are as many ends as starts. Ctrl-C is not heard.)");
  py::class_<WindingNumber>(module, "WindingNumber",
                            "Inside and outside of a surface, also of an open one such as a scan.")
      .def(py::init([](const TriangleMesh& mesh) {
             const Unlocked unlocked;
             return WindingNumber(mesh);
           }),
           arg("mesh"),
           R"(Prepares a copy of the mesh.

Raises InvalidInput if the mesh has no triangle, a vertex that is not finite, or a wrong index.)")
      .def(
          "at",
          [](const WindingNumber& winding, const py::object& points, double tolerance) {
            const Points given(points, "points");
            const Eigen::VectorXd numbers = [&] {
              const Unlocked unlocked;
              return geometry::winding_numbers(winding, given.columns(), tolerance);
            }();
            return py::array_t<double>(numbers.size(), numbers.data());
          },
          arg("points"), py::kw_only(), arg("tolerance") = 0.01,
          R"(The winding number of each of (N, 3) points [mm], within the tolerance: (N,).

1 inside and 0 outside of a closed surface, in between near a hole; NaN for a point that is not
finite. tolerance=0 is the exact sum of all solid angles. Ctrl-C is not heard.)")
      .def(
          "contains",
          [](const WindingNumber& winding, const py::object& points) {
            const Points given(points, "points");
            const Eigen::VectorX<bool> inside = [&] {
              const Unlocked unlocked;
              return geometry::contained(winding, given.columns());
            }();
            return py::array_t<bool>(inside.size(), inside.data());
          },
          arg("points"),
          "Whether the winding number of each of (N, 3) points exceeds 1/2: (N,) bool.");
}

/// The result of `compare`: `palpate compare` prints the same figures.
struct Comparison {
  geometry::SurfaceDistances spread;
  geometry::HausdorffDistance largest;
};

void add_comparison(py::module_& module) {
  const auto spread = [](auto member) {
    return [member](const Comparison& comparison) { return comparison.spread.*member; };
  };
  using geometry::SurfaceDistances;
  py::class_<Comparison>(module, "Comparison",
                         "Signed distances from one surface to another, over its area.")
      .def_property_readonly("mean", spread(&SurfaceDistances::mean),
                             "[mm] of the signed distances; positive on the side of the normals.")
      .def_property_readonly("rms", spread(&SurfaceDistances::rms),
                             "[mm] square root of the mean square.")
      .def_property_readonly("median", spread(&SurfaceDistances::median),
                             "[mm] absolute distance not exceeded on half of the area.")
      .def_property_readonly("p90", spread(&SurfaceDistances::p90),
                             "[mm] absolute distance not exceeded on nine tenths of the area.")
      .def_property_readonly("area", spread(&SurfaceDistances::area), "[mm^2] of the surface.")
      .def_property_readonly("cells", spread(&SurfaceDistances::cells),
                             "The surface in small triangles (a copy), one for each distance.")
      .def_property_readonly(
          "distance",
          [](const py::object& self) {
            return vector_view(self.cast<Comparison&>().spread.distance, self);
          },
          "[mm] (T,) signed mean distance of each cell.")
      .def_property_readonly(
          "hausdorff",
          [](const Comparison& comparison) {
            return std::pair(comparison.largest.lower, comparison.largest.upper);
          },
          "[mm] lower and upper bound of the Hausdorff distance, of both directions.")
      .def("__repr__", [](const Comparison& comparison) {
        return "<palpate.Comparison: median " + std::to_string(comparison.spread.median) +
               " mm, rms " + std::to_string(comparison.spread.rms) + " mm, at most " +
               std::to_string(comparison.largest.upper) + " mm>";
      });
  module.def(
      "compare",
      [](const TriangleMesh& mesh, const TriangleMesh& reference) {
        const Unlocked unlocked;
        return Comparison{geometry::surface_distances(mesh, reference),
                          geometry::hausdorff_distance(mesh, reference)};
      },
      arg("mesh"), arg("reference"),
      R"(Distances from a surface to a reference, over the area of the surface.

Raises InvalidInput. Ctrl-C is not heard.)");
}

void add_registration(py::module_& module) {
  py::class_<Registration>(module, "Registration", "The result of register_points().")
      .def_property_readonly(
          "T_target_source",
          [](const Registration& found) { return copy_of(found.T_target_source.matrix()); },
          "(4, 4) moves source points [mm] to the frame of the target.")
      .def_property_readonly(
          "accepted",
          [](const Registration& found) {
            return found.verdict == geometry::RegistrationVerdict::accepted;
          },
          "Whether the pose can be relied on. Read this before you use it.")
      .def_property_readonly(
          "verdict", [](const Registration& found) { return geometry::to_string(found.verdict); },
          "'accepted', 'not_converged', 'too_few_points', 'little_overlap', 'slides', "
          "'ambiguous' or 'poor_fit'.")
      .def_readonly("reason", &Registration::reason, "The verdict in a sentence, with figures.")
      .def_readonly("rms", &Registration::rms,
                    "[mm] of the distances of the inliers from the surface; NaN without any.")
      .def_readonly("median", &Registration::median,
                    "[mm] median distance of the finite points from the surface; if min_overlap is "
                    "below 0.5, of the nearest 2 min_overlap of them.")
      .def_readonly("inliers", &Registration::inliers,
                    "Number of points whose distance is consistent with the others'.")
      .def_readonly("overlap", &Registration::overlap, "The inliers' share of the finite points.")
      .def_property_readonly(
          "runner_up", [](const Registration& found) { return found.runner_up; },
          "[mm] the same at the best different pose; None if there is none.")
      .def_property_readonly(
          "centre", [](const Registration& found) { return copy_of(found.centre); },
          "[mm] (3,) centroid of the moved points.")
      .def_property_readonly(
          "covariance", [](const Registration& found) { return copy_of(found.covariance); },
          "(6, 6) of the rotation about the centre [rad] and the translation [mm].")
      .def("__repr__", [](const Registration& found) {
        return "<palpate.Registration: " + std::string(to_string(found.verdict)) + ": " +
               found.reason + ">";
      });
  def_with_options<RegistrationOptions>(
      module,
      "register_points(points: ArrayLike, target: TriangleMesh, *, start: ArrayLike | None = None, "
      "progress: Callable | None = None",
      "Registration",
      R"(Registers (N, 3) points [mm] rigidly to a mesh, and judges the result.

points: those that are not finite are ignored. A C-contiguous float64 array is read in place.
start: (4, 4) start pose of the search; None: none of the points is moved.
progress: called as progress(done, total) after each part of the work; Ctrl-C is heard then.
Raises InvalidInput. A pose that cannot be relied on is a result, not an error: see `accepted`.)",
      [](const py::object& points, const TriangleMesh& target, const py::object& start,
         const py::object& progress, const py::kwargs& keywords) {
        const Points given(points, "points");
        auto options = options_from<RegistrationOptions>(keywords);
        options.T_target_source_start = isometry(start, "start");
        LongWork work(progress);
        options.progress = work.report();
        return work.run(
            [&] { return geometry::register_points(given.columns(), target, options); });
      },
      arg("points"), arg("target"), kw_only(), arg("start") = py::none(),
      arg("progress") = py::none());
}

}  // namespace

void add_surface_functions(py::module_& module) {
  add_queries(module);
  add_comparison(module);
  add_registration(module);
}

}  // namespace palpate::python
